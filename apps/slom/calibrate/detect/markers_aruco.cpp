#include <algorithm>
#include <array>
#include <map>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <opencv2/aruco.hpp>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "calibrate/detect/markers.hpp"
#include "calibrate/library.hpp"
#include "error.hpp"

namespace slom::app::calib {

namespace {

namespace aruco = cv::aruco;

struct Dictionary {
  int name, markers;
};

/// OpenCV's dictionaries. A name gives the bits along a side and the number of markers.
const std::map<std::string, Dictionary> dictionaries{{"4x4_50", {aruco::DICT_4X4_50, 50}},
                                                     {"4x4_100", {aruco::DICT_4X4_100, 100}},
                                                     {"4x4_250", {aruco::DICT_4X4_250, 250}},
                                                     {"4x4_1000", {aruco::DICT_4X4_1000, 1000}},
                                                     {"5x5_50", {aruco::DICT_5X5_50, 50}},
                                                     {"5x5_100", {aruco::DICT_5X5_100, 100}},
                                                     {"5x5_250", {aruco::DICT_5X5_250, 250}},
                                                     {"5x5_1000", {aruco::DICT_5X5_1000, 1000}},
                                                     {"6x6_50", {aruco::DICT_6X6_50, 50}},
                                                     {"6x6_100", {aruco::DICT_6X6_100, 100}},
                                                     {"6x6_250", {aruco::DICT_6X6_250, 250}},
                                                     {"6x6_1000", {aruco::DICT_6X6_1000, 1000}},
                                                     {"7x7_50", {aruco::DICT_7X7_50, 50}},
                                                     {"7x7_100", {aruco::DICT_7X7_100, 100}},
                                                     {"7x7_250", {aruco::DICT_7X7_250, 250}},
                                                     {"7x7_1000", {aruco::DICT_7X7_1000, 1000}},
                                                     {"original", {aruco::DICT_ARUCO_ORIGINAL, 1024}}};

constexpr int markers_of_36h11 = 587;
constexpr int border_of_aprilgrid = 2;  // black bits around a tag; ArUco and newer AprilTags have one

cv::Mat viewOf(const Photograph& photo) {
  return {photo.size.height, photo.size.width, CV_8UC1, const_cast<std::uint8_t*>(photo.grey.data())};
}

struct Markers {
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<int> ids;
};

Markers detect(const cv::Mat& image, int dictionary, int border) {
  auto parameters = aruco::DetectorParameters::create();
  parameters->markerBorderBits = border;
  Markers markers;
  aruco::detectMarkers(image, aruco::getPredefinedDictionary(dictionary), markers.corners, markers.ids,
                       parameters);
  return markers;
}

/// Moves corners to where the edges within a window meet. `half` is half the side of the window [px]. Leaves out
/// corners that move too far.
std::vector<FoundCorner> refined(const cv::Mat& image, const std::vector<FoundCorner>& found, double half) {
  const int window = std::clamp(int(half), 2, 12);
  std::vector<cv::Point2f> points;
  for (const FoundCorner& corner : found)
    points.emplace_back(float(corner.pixel.x()), float(corner.pixel.y()));
  if (points.empty()) return {};
  cv::cornerSubPix(image, points, {window, window}, {-1, -1},
                   {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-4});
  std::vector<FoundCorner> kept;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const FoundCorner corner{found[i].index, vec2(points[i].x, points[i].y)};
    const bool is_whole = corner.pixel.x() >= window && corner.pixel.y() >= window &&
                          corner.pixel.x() <= image.cols - 1 - window &&
                          corner.pixel.y() <= image.rows - 1 - window;
    if (is_whole && (corner.pixel - found[i].pixel).norm() < 0.5 * window + 0.5) kept.push_back(corner);
  }
  return kept;
}

/// Returns the shortest side of a detected marker [px].
double shortestSide(const Markers& markers) {
  double side = std::numeric_limits<double>::infinity();
  for (const auto& marker : markers.corners) {
    for (std::size_t k = 0; k < 4; ++k) side = std::min(side, cv::norm(marker[k] - marker[(k + 1) % 4]));
  }
  return side;
}

/// Refines OpenCV's own corners, because some of them are half a pixel off. The windows stay clear of markers.
std::vector<FoundCorner> findCharuco(const Board& board, const cv::Mat& image) {
  const int name = dictionaries.at(board.dictionary).name;
  const Markers markers = detect(image, name, 1);
  std::vector<FoundCorner> found;
  if (markers.ids.empty()) return found;
  const auto charuco =
      aruco::CharucoBoard::create(board.columns, board.rows, float(board.square_m), float(board.marker_m),
                                  aruco::getPredefinedDictionary(name));
  std::vector<cv::Point2f> corners;
  std::vector<int> ids;
  aruco::interpolateCornersCharuco(markers.corners, markers.ids, image, charuco, corners, ids);
  for (std::size_t i = 0; i < ids.size(); ++i) found.push_back({ids[i], vec2(corners[i].x, corners[i].y)});
  const double clear_m = std::min((board.square_m - board.marker_m) / 2, 0.25 * board.square_m);
  return refined(image, found, 0.9 * shortestSide(markers) / board.marker_m * clear_m);
}

/// Returns the corners of a tag, clockwise as a detector lists them, starting at `first`.
std::array<int, 4> gridIndices(const Board& board, int tag, int first) {
  const int column = 2 * (tag % board.columns), row = 2 * (tag / board.columns),
            width = board.cornerColumns();
  const int lower = row * width + column, upper = lower + width;
  std::array<int, 4> clockwise{upper, upper + 1, lower + 1, lower};
  std::rotate(clockwise.begin(), clockwise.begin() + first, clockwise.end());
  return clockwise;
}

std::vector<FoundCorner> asGrid(const Board& board, const Markers& tags, int first) {
  std::vector<FoundCorner> found;
  for (std::size_t i = 0; i < tags.ids.size(); ++i) {
    if (tags.ids[i] >= board.columns * board.rows) continue;  // a tag of another board
    const std::array<int, 4> indices = gridIndices(board, tags.ids[i], first);
    for (std::size_t k = 0; k < 4; ++k)
      found.push_back({indices[k], vec2(tags.corners[i][k].x, tags.corners[i][k].y)});
  }
  return found;
}

/// Returns the sum of squared distances between corners and their predictions by a homography [px^2].
double bend(const Board& board, const std::vector<FoundCorner>& found) {
  std::vector<vec2> on_board, pixels;
  for (const FoundCorner& corner : found) {
    on_board.push_back(vec2(board.corner(corner.index).head<2>()));
    pixels.push_back(corner.pixel);
  }
  const Eigen::Matrix3d H = findHomography(on_board, pixels);
  double sum = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i)
    sum += ((H * on_board[i].homogeneous()).hnormalized() - pixels[i]).squaredNorm();
  return sum;
}

/// Predicts the corners of each tag from the tag itself and the tags around it, by a homography that holds for most
/// of these. In a small region of the image, a homography suits any lens. Leaves out corners that lie elsewhere,
/// because they were found at a square between tags.
std::vector<FoundCorner> smoothed(const Board& board, const std::vector<FoundCorner>& found, double side) {
  std::vector<FoundCorner> kept;
  for (std::size_t tag = 0; tag + 3 < found.size(); tag += 4) {  // the corners of a tag are successive
    std::vector<cv::Point2f> on_board, pixels;
    const vec3 middle = board.corner(found[tag].index);
    for (const FoundCorner& other : found) {
      const vec3 corner = board.corner(other.index);
      if ((corner - middle).lpNorm<Eigen::Infinity>() > 2.1 * (1 + board.spacing) * board.square_m) continue;
      on_board.emplace_back(float(corner.x()), float(corner.y()));
      pixels.emplace_back(float(other.pixel.x()), float(other.pixel.y()));
    }
    if (pixels.size() < 8) continue;
    const cv::Mat H = cv::findHomography(on_board, pixels, cv::LMEDS);
    if (H.empty()) continue;
    for (std::size_t k = tag; k < tag + 4; ++k) {
      const vec3 corner = board.corner(found[k].index);
      std::vector<cv::Point2f> predicted, at{{float(corner.x()), float(corner.y())}};
      cv::perspectiveTransform(at, predicted, H);
      const vec2 pixel(predicted[0].x, predicted[0].y);
      if ((pixel - found[k].pixel).norm() < 0.1 * side) kept.push_back({found[k].index, pixel});
    }
  }
  return kept;
}

/// Finds an AprilGrid. Printed tags may be turned by quarters against OpenCV's tags. Chooses the turn that puts the
/// corners on a plane.
std::vector<FoundCorner> findAprilgrid(const Board& board, const cv::Mat& image) {
  const Markers tags = detect(image, aruco::DICT_APRILTAG_36h11, border_of_aprilgrid);
  std::vector<FoundCorner> best;
  double least = std::numeric_limits<double>::infinity();
  for (int first = 0; first < 4; ++first) {
    std::vector<FoundCorner> found = asGrid(board, tags, first);
    if (found.size() < 8) return {};  // with one tag alone all turns fit
    const double sum = bend(board, found);
    if (sum < least) least = sum, best = std::move(found);
  }
  const double side = shortestSide(tags);
  // The window ends at the next edge: of the square, or of the tag's code.
  return refined(image, smoothed(board, best, side), 0.7 * std::min(board.spacing, 0.2) * side);
}

}  // namespace

std::vector<FoundCorner> findMarkers(const Board& board, const Photograph& photo) {
  const cv::Mat image = viewOf(photo);
  return board.kind == BoardKind::charuco ? findCharuco(board, image) : findAprilgrid(board, image);
}

std::vector<SeenMarker> seenMarkers(const std::string& dictionary, const Photograph& photo) {
  const Markers markers = detect(viewOf(photo), dictionaries.at(dictionary).name, 1);
  std::vector<SeenMarker> seen;
  for (std::size_t i = 0; i < markers.ids.size(); ++i) {
    const auto& c = markers.corners[i];
    const cv::Point2f centre = (c[0] + c[1] + c[2] + c[3]) / 4;
    seen.push_back({markers.ids[i], vec2(centre.x, centre.y)});
  }
  return seen;
}

void requireDictionary(const Board& board) {
  const bool is_charuco = board.kind == BoardKind::charuco;
  const auto dictionary = dictionaries.find(board.dictionary);
  if (is_charuco && dictionary == dictionaries.end()) {
    std::vector<std::string> names;
    for (const auto& [name, unused] : dictionaries) names.push_back(name);
    throw UserError(fmt::format("--board {}: there is no dictionary {}; there are {}", toString(board),
                                board.dictionary, fmt::join(names, ", ")));
  }
  const int needed = is_charuco ? board.columns * board.rows / 2 : board.columns * board.rows;
  const int markers = is_charuco ? dictionary->second.markers : markers_of_36h11;
  if (needed <= markers) return;
  throw UserError(
      fmt::format("--board {}: its {} markers are more than the {} of the dictionary; correct the size{}",
                  toString(board), needed, markers, is_charuco ? " or the dictionary" : ""));
}

}  // namespace slom::app::calib
