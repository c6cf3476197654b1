#include "calibrate/detect/marker_layout.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <optional>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <fmt/format.h>

#include "calibrate/detect/board_size.hpp"
#include "error.hpp"

namespace slom::app::calib {
namespace {

constexpr std::size_t fewest_markers = 6;
constexpr int most_columns = 100;
constexpr double not_explained = 1;  // squares
constexpr double explained = 0.3;    // squares; lenses bend boards by less, and few markers are read wrongly
constexpr double far_worse = 3;      // misfit of the stated board, divided by that of another one

/// Column and row of the square of a marker.
std::pair<int, int> squareOf(int id, const MarkerLayout& layout) {
  const int of_two_rows = layout.columns;  // markers in two successive rows
  const int first = layout.is_legacy ? (layout.columns + 1) / 2 : layout.columns / 2;
  const int rest = id % of_two_rows, row = 2 * (id / of_two_rows) + (rest < first ? 0 : 1);
  const bool begins_with_marker = layout.is_legacy == (row % 2 == 0);
  return {2 * (rest < first ? rest : rest - first) + (begins_with_marker ? 0 : 1), row};
}

bool areOnLine(const std::vector<vec2>& points) {
  Eigen::MatrixXd all(2, points.size());
  for (std::size_t i = 0; i < points.size(); ++i) all.col(Eigen::Index(i)) = points[i];
  all.colwise() -= all.rowwise().mean().eval();
  const Eigen::VectorXd sizes = all.jacobiSvd().singularValues();
  return sizes[1] < 0.05 * sizes[0];
}

/// Returns the mean of the distances, cut at not_explained. A median would ignore the few markers at the ends of rows,
/// which alone distinguish some layouts.
double meanOf(const std::vector<double>& distances) {
  double sum = 0;
  for (const double distance : distances) sum += std::min(not_explained, distance);
  return sum / double(distances.size());
}

/// Returns the distances of the markers from their squares, mapped by a homography from the photograph [squares]. The
/// fit leaves out the worst markers, one after the other. Returns an empty list if there is no homography.
std::vector<double> distances(const std::vector<vec2>& squares, const std::vector<vec2>& pixels) {
  std::vector<vec2> from = pixels, to = squares;
  const std::size_t fewest_left = std::max<std::size_t>(5, pixels.size() - pixels.size() / 6 - 1);
  while (true) {
    const Eigen::Matrix3d H = findHomography(from, to);
    if (!H.allFinite() || areOnLine(to)) return {};
    const auto distance = [&](const vec2& pixel, const vec2& square) {
      const double apart = ((H * pixel.homogeneous()).hnormalized() - square).norm();
      return std::isfinite(apart) ? apart : not_explained;
    };
    std::vector<double> of_fit;
    for (std::size_t i = 0; i < from.size(); ++i) of_fit.push_back(distance(from[i], to[i]));
    const auto worst = std::max_element(of_fit.begin(), of_fit.end());
    if (from.size() <= fewest_left || *worst < 0.5 * explained) {
      std::vector<double> found;
      for (std::size_t i = 0; i < pixels.size(); ++i) found.push_back(distance(pixels[i], squares[i]));
      return found;
    }
    from.erase(from.begin() + (worst - of_fit.begin()));
    to.erase(to.begin() + (worst - of_fit.begin()));
  }
}

/// Returns the distances of the markers of one photograph; empty if they are too few or lie in no plane.
std::vector<double> distancesIn(const std::vector<SeenMarker>& markers, const MarkerLayout& layout) {
  std::vector<vec2> squares, pixels;
  for (const SeenMarker& marker : markers) {
    const auto [column, row] = squareOf(marker.id, layout);
    squares.emplace_back(column, row);
    pixels.push_back(marker.centre);
  }
  return areOnLine(squares) ? std::vector<double>() : distances(squares, pixels);
}

using MarkersByPhoto = std::vector<std::vector<SeenMarker>>;

MarkersByPhoto markersIn(const std::vector<std::string>& photos, const std::string& dictionary) {
  MarkersByPhoto seen;
  for (const std::string& file : photos) {
    std::string reason;
    seen.emplace_back();
    try {
      if (const auto photo = readPhotograph(file, reason)) seen.back() = seenMarkers(dictionary, *photo);
    } catch (const UserError&) {
      throw;
    } catch (const std::exception&) {  // thrown by OpenCV for a photograph that it cannot search
    }
  }
  return seen;
}

std::size_t photosWithMarkers(const MarkersByPhoto& seen) {
  return std::size_t(std::count_if(seen.begin(), seen.end(),
                                   [](const auto& markers) { return markers.size() >= fewest_markers; }));
}

/// A dictionary other than the stated one, whose markers the photographs show, and the layout of these markers.
struct OtherDictionary {
  std::string name;
  MarkerLayout layout;
};

std::optional<OtherDictionary> otherDictionary(const Board& board, const std::vector<std::string>& photos) {
  std::optional<OtherDictionary> best;
  for (const char* const bits : {"4x4", "5x5", "6x6", "7x7"}) {
    if (board.dictionary.starts_with(bits)) continue;
    const MarkersByPhoto seen = markersIn(photos, fmt::format("{}_1000", bits));
    const MarkerLayout layout = likeliestLayout(seen);
    if (layout.columns == 0 || (best && best->layout.misfit <= layout.misfit)) continue;
    int largest = 0;
    for (const auto& markers : seen) {
      for (const SeenMarker& marker : markers) {
        if (squareOf(marker.id, layout).second < layout.rows) largest = std::max(largest, marker.id);
      }
    }
    const int size = largest < 50 ? 50 : largest < 100 ? 100 : largest < 250 ? 250 : 1000;
    best = OtherDictionary{fmt::format("{}_{}", bits, size), layout};
  }
  return best;
}

[[noreturn]] void refuse(const std::string& photo, const Board& board, const std::string& dictionary,
                         const MarkerLayout& layout) {
  if (layout.is_legacy) {
    throw UserError(fmt::format(
        "{}: the markers match a board of {}x{} whose upper left square is white, as printed by OpenCV "
        "before 4.6; print the board again with OpenCV 4.6 or later",
        photo, layout.columns, layout.rows));
  }
  const std::string other =
      dictionary == board.dictionary ? "" : fmt::format(" belong to the dictionary {} and", dictionary);
  throw UserError(
      fmt::format("{0}: the markers{1} match a board of {2}x{3}; give --board charuco:{2}x{3}:{4}", photo,
                  other, layout.columns, layout.rows, dictionary));
}

}  // namespace

double misfitOf(const MarkerLayout& layout, const std::vector<std::vector<SeenMarker>>& photos) {
  double sum = 0;
  std::size_t count = 0;
  for (const std::vector<SeenMarker>& markers : photos) {
    if (markers.size() < fewest_markers) continue;
    const std::vector<double> found = distancesIn(markers, layout);
    sum += found.empty() ? not_explained : meanOf(found);
    ++count;
  }
  return count == 0 ? not_explained : sum / double(count);
}

MarkerLayout likeliestLayout(const std::vector<std::vector<SeenMarker>>& photos) {
  MarkerLayout best;
  best.misfit = explained;
  for (int columns = 3; columns <= most_columns; ++columns) {
    for (const bool is_legacy : {false, true}) {
      MarkerLayout layout{columns, 0, is_legacy};
      layout.misfit = misfitOf(layout, photos);
      if (layout.misfit < best.misfit) best = layout;
    }
  }
  if (best.columns == 0) return {};
  for (const std::vector<SeenMarker>& markers : photos) {
    if (markers.size() < fewest_markers) continue;
    const std::vector<double> found = distancesIn(markers, best);
    for (std::size_t i = 0; i < found.size(); ++i) {  // other markers were read wrongly
      if (found[i] < explained) best.rows = std::max(best.rows, squareOf(markers[i].id, best).second + 1);
    }
  }
  best.rows = std::max(best.rows, 3);
  return best;
}

void requireLayoutLikely(const Board& board, const std::vector<std::string>& photos) {
  if (board.kind != BoardKind::charuco || photos.empty()) return;
  const std::vector<std::string> some = someOf(photos);
  const MarkersByPhoto seen = markersIn(some, board.dictionary);
  if (photosWithMarkers(seen) == 0) {
    if (const auto other = otherDictionary(board, some))
      refuse(some.front(), board, other->name, other->layout);
    return;
  }
  const double stated = misfitOf({board.columns, board.rows}, seen);
  const MarkerLayout likeliest = likeliestLayout(seen);
  if (likeliest.columns == 0 || stated < far_worse * likeliest.misfit + 0.02) return;
  const auto first = std::find_if(seen.begin(), seen.end(),
                                  [](const auto& markers) { return markers.size() >= fewest_markers; });
  refuse(some[std::size_t(first - seen.begin())], board, board.dictionary, likeliest);
}

}  // namespace slom::app::calib
