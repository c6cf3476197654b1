#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "calibrate/detect/chessboard.hpp"
#include "calibrate/detect/detector.hpp"
#include "calibrate/detect/markers.hpp"
#include "calibrate/library.hpp"

namespace slom::app::calib {
namespace {

using Points = std::vector<cv::Point2f>;

cv::Mat matrixOf(const Photograph& photo) {
  return {photo.size.height, photo.size.width, CV_8UC1, const_cast<std::uint8_t*>(photo.grey.data())};
}

/// Longest sides of the images in which boards are searched [px]; corners are refined in the whole image. If
/// something looks like a board, findChessboardCorners takes 2.3 s on average at 1600 px, and 0.08 s at 800 px.
/// findChessboardCornersSB finds every board that it then misses. Of 72 boards before other photographs, including
/// small, blurred and noisy ones, both ways find the same 69.
constexpr int side_at_first = 800, longest_side = 1600;

/// Returns the distance from each corner to the nearest of its neighbours on the board [px].
std::vector<double> nearest(const Points& corners, const cv::Size& size) {
  std::vector<double> distances(corners.size(), std::numeric_limits<double>::infinity());
  const auto measure = [&](int i, int j) {
    const double distance = cv::norm(corners[std::size_t(i)] - corners[std::size_t(j)]);
    for (const int k : {i, j}) distances[std::size_t(k)] = std::min(distances[std::size_t(k)], distance);
  };
  for (int row = 0; row < size.height; ++row) {
    for (int column = 0; column < size.width; ++column) {
      const int i = row * size.width + column;
      if (column + 1 < size.width) measure(i, i + 1);
      if (row + 1 < size.height) measure(i, i + size.width);
    }
  }
  return distances;
}

/// Refines each corner within a window of half a square: large enough to average noise, too small for other edges of
/// a tilted board. On the sample images of OpenCV this calibrates to 0.18 px. One small window for all gives 0.20 px.
/// Windows that reach 0.35 of the way to the next corner give 0.23 px, with outliers of 3.5 px.
/// findChessboardCornersSB alone gives 0.26 px.
void refine(const cv::Mat& image, const cv::Size& size, Points& corners) {
  const std::vector<double> distances = nearest(corners, size);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const int half = std::max(2, int(std::lround(0.25 * distances[i])));
    Points one{corners[i]};
    cv::cornerSubPix(image, one, {half, half}, {-1, -1},
                     {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-4});
    corners[i] = one[0];
  }
}

/// Returns the image with no side longer than `longest`. `scale`: its size, divided by that of the whole image.
cv::Mat reduced(const cv::Mat& image, int longest, double& scale) {
  scale = std::min(1.0, double(longest) / std::max(image.cols, image.rows));
  if (scale == 1) return image;
  cv::Mat small;
  cv::resize(image, small, {}, scale, scale, cv::INTER_AREA);
  return small;
}

/// Returns the corners row by row from any end; none if there is no board.
Points findChessboard(const cv::Mat& image, const cv::Size& size) {
  double scale = 1;
  Points corners;
  // Without the fast check, noise amplified to full contrast keeps the search busy for many seconds.
  constexpr int flags = cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_FAST_CHECK;
  const bool is_found =
      cv::findChessboardCorners(reduced(image, side_at_first, scale), size, corners, flags) ||
      cv::findChessboardCornersSB(reduced(image, longest_side, scale), size, corners,
                                  cv::CALIB_CB_NORMALIZE_IMAGE);
  if (!is_found) return {};
  for (cv::Point2f& p : corners) p = {float((p.x + 0.5) / scale - 0.5), float((p.y + 0.5) / scale - 0.5)};
  refine(image, size, corners);
  return corners;
}

/// Returns whether the corners determine the pose of the board.
bool givePose(const Board& board, const std::vector<FoundCorner>& found) {
  constexpr std::size_t least = 6;
  std::vector<vec2> on_board, in_image;
  for (const FoundCorner& corner : found) {
    on_board.push_back(vec2(board.corner(corner.index).head<2>()));
    in_image.push_back(corner.pixel);
  }
  return found.size() >= least && !onLineButOne(on_board, 1e-4) && !onLineButOne(in_image, 2e-3);
}

/// Turns off OpenCV's threads. Threads of the command search photographs in parallel, and OpenCV's own threads within
/// them would keep more photographs in memory.
void keepToOneThread() {
  static std::once_flag once;
  std::call_once(once, [] { cv::setNumThreads(0); });
}

}  // namespace

std::vector<FoundCorner> findBoard(const Board& board, const Photograph& photo) {
  keepToOneThread();
  std::vector<FoundCorner> found;
  if (board.kind == BoardKind::chessboard) {
    std::vector<vec2> corners;
    for (const cv::Point2f& p : findChessboard(matrixOf(photo), {board.columns, board.rows}))
      corners.emplace_back(p.x, p.y);
    if (corners.empty()) return found;
    corners = inBoardOrder(board, std::move(corners), photo);
    for (std::size_t i = 0; i < corners.size(); ++i) found.push_back({int(i), corners[i]});
  } else {
    found = findMarkers(board, photo);
    std::sort(found.begin(), found.end(),
              [](const FoundCorner& a, const FoundCorner& b) { return a.index < b.index; });
  }
  if (!givePose(board, found)) found.clear();
  return found;
}

bool showsChessboard(const Board& board, const Photograph& photo) {
  keepToOneThread();
  double scale = 1;
  Points corners;
  return cv::findChessboardCornersSB(reduced(matrixOf(photo), longest_side, scale),
                                     {board.columns, board.rows}, corners, cv::CALIB_CB_NORMALIZE_IMAGE);
}

ChessboardSize largestChessboard(const Photograph& photo) {
  keepToOneThread();
  constexpr int least = 3;  // corners along a side
  double scale = 1;
  Points corners;
  cv::Mat grid;
  const bool is_found =
      cv::findChessboardCornersSB(reduced(matrixOf(photo), longest_side, scale), {least, least}, corners,
                                  cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_LARGER, grid);
  if (!is_found || grid.empty()) return {};
  return {std::max(grid.cols, grid.rows), std::min(grid.cols, grid.rows)};
}

void requireDetector(const Board& board) {
  if (board.kind != BoardKind::chessboard) requireDictionary(board);
}

}  // namespace slom::app::calib
