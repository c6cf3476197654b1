#include "calibration/initialization/view_misfit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <fmt/format.h>

#include "calibration/initialization/plane_view.hpp"
#include "calibration/median.hpp"
#include "slom/calibration/error.hpp"
#include "slom/calibration/number_text.hpp"

namespace slom::calibration {
namespace {

constexpr std::size_t fewest_corners = 9;
constexpr double not_smooth = 0.1, hardly_smooth = 0.04, smooth = 0.03;  // fractions of the extent
constexpr double least_px = 3;

struct Pairs {
  std::vector<vec2> board, pixels;
};

/// A map fitted to the corners that count. Returns the images of all corners.
using SmoothMap = std::function<std::vector<vec2>(const Pairs&, const std::vector<bool>& counts)>;

std::vector<vec2> byHomography(const Pairs& pairs, const std::vector<bool>& counts) {
  Pairs used;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i]) used.board.push_back(pairs.board[i]), used.pixels.push_back(pairs.pixels[i]);
  }
  const Eigen::Matrix3d H = findHomography(used.board, used.pixels);
  std::vector<vec2> mapped;
  for (const vec2& p : pairs.board) mapped.push_back(vec2((H * p.homogeneous()).hnormalized()));
  return mapped;
}

int terms(int degree) { return (degree + 1) * (degree + 2) / 2; }

std::vector<vec2> byPolynomial(const Pairs& pairs, const std::vector<bool>& counts, int degree) {
  const auto n = Eigen::Index(pairs.board.size());
  double size = 0;
  for (const vec2& p : pairs.board) size = std::max(size, p.norm());
  Eigen::MatrixXd A(n, terms(degree)), b(n, 2);
  for (Eigen::Index i = 0; i < n; ++i) {
    const vec2 p(pairs.board[std::size_t(i)] / size);
    int column = 0;
    for (int x = 0; x <= degree; ++x) {
      for (int y = 0; x + y <= degree; ++y) A(i, column++) = std::pow(p.x(), x) * std::pow(p.y(), y);
    }
    b.row(i) = pairs.pixels[std::size_t(i)].transpose();
  }
  Eigen::VectorXd weights(n);
  for (Eigen::Index i = 0; i < n; ++i) weights[i] = counts[std::size_t(i)] ? 1 : 0;
  const Eigen::MatrixXd mapped =
      A *
      Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(weights.asDiagonal() * A).solve(weights.asDiagonal() * b);
  std::vector<vec2> result;
  for (Eigen::Index i = 0; i < n; ++i) result.push_back(vec2(mapped(i, 0), mapped(i, 1)));
  return result;
}

/// Returns the median distance from the map. Up to a tenth of the corners does not count, if they are far off.
double medianDistance(const Pairs& pairs, const SmoothMap& map, int parameters) {
  constexpr int rounds = 4;
  const std::size_t n = pairs.board.size();
  std::vector<bool> counts(n, true);
  double median = 0;
  for (int round = 0; round < rounds; ++round) {
    const std::vector<vec2> mapped = map(pairs, counts);
    std::vector<std::pair<double, std::size_t>> distances;
    for (std::size_t i = 0; i < n; ++i) {
      const double distance = (mapped[i] - pairs.pixels[i]).norm();
      distances.emplace_back(std::isfinite(distance) ? distance : std::numeric_limits<double>::infinity(), i);
    }
    std::sort(distances.begin(), distances.end());
    median = distances[n / 2].first;
    std::vector<bool> next(n, true);
    for (std::size_t k = n - n / 10; k < n; ++k) {
      if (distances[k].first > 4 * median) next[distances[k].second] = false;
    }
    if (next == counts) break;
    counts = std::move(next);
  }
  return median / std::sqrt(std::max(0.05, 1 - parameters / (2.0 * double(n))));
}

ViewMisfit misfitOf(const Pairs& pairs) {
  const std::size_t n = pairs.board.size();
  if (n < fewest_corners) return {};
  const int degree = n >= 40 ? 4 : n >= 24 ? 3 : n >= 14 ? 2 : 1;
  ViewMisfit misfit;
  misfit.px = std::min(
      medianDistance(pairs, byHomography, 8),
      medianDistance(
          pairs,
          [&](const Pairs& p, const std::vector<bool>& counts) { return byPolynomial(p, counts, degree); },
          2 * terms(degree)));
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const vec2& p : pairs.pixels) mean += p / double(n);
  double square = 0;
  for (const vec2& p : pairs.pixels) square += (p - mean).squaredNorm() / double(n);
  misfit.extent_px = std::sqrt(square);
  return misfit;
}

Pairs pairsOf(const View& view) {
  const BoardPlane plane = fitPlane(view.corners);
  Pairs pairs;
  for (const Corner& corner : view.corners) {
    pairs.board.push_back(plane.coordinates(corner.world));
    pairs.pixels.push_back(corner.pixel);
  }
  return pairs;
}

bool exceeds(const ViewMisfit& misfit, double part) { return misfit.px > least_px && misfit.part() > part; }

/// The grid of columns and rows that the corners of all views lie on; nothing if they lie on none.
struct Lattice {
  int columns = 0, rows = 0;
  int count() const { return columns * rows; }
};

/// Returns the distinct values. Values within a thousandth of their range are the same.
std::vector<double> distinct(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  std::vector<double> result;
  for (const double value : values) {
    if (result.empty() || value - result.back() > 1e-3 * (values.back() - values.front()))
      result.push_back(value);
  }
  return result;
}

std::optional<Lattice> latticeOf(const std::vector<const View*>& views) {
  std::vector<double> along[3];
  for (const View* view : views) {
    for (const Corner& corner : view->corners) {
      for (int i = 0; i < 3; ++i) along[i].push_back(corner.world[i]);
    }
  }
  std::vector<int> sides;
  for (auto& values : along) {
    if (const std::size_t count = distinct(values).size(); count > 1) sides.push_back(int(count));
  }
  if (sides.size() != 2 || sides[0] * sides[1] > 10'000) return {};
  return Lattice{sides[0], sides[1]};
}

/// A different numbering: the position of the corner with this index, from 0 on, in the order of the file.
struct Renumbering {
  std::string name;
  std::function<vec2(int index)> place;
};

std::vector<Renumbering> renumberings(const Lattice& grid) {
  const int m = grid.columns, n = grid.rows;
  const auto exchanged = [&](int length, int other) {
    return Renumbering{
        fmt::format("numbered in rows of {} instead of {} (rows and columns are exchanged)", length, other),
        [=](int i) { return vec2(double(i % length), double(i / length)); }};
  };
  const auto snake = [&](int length) {
    return Renumbering{fmt::format("numbered in rows of {} that run back and forth", length), [=](int i) {
                         const int row = i / length, column = i % length;
                         return vec2(double(row % 2 == 0 ? column : length - 1 - column), double(row));
                       }};
  };
  const auto staggered = [&](int length) {
    return Renumbering{
        fmt::format("as an asymmetric grid of circles with rows of {}, every other one shifted by half a "
                    "spacing,",
                    length),
        [=](int i) { return vec2(2.0 * (i % length) + (i / length) % 2, double(i / length)); }};
  };
  return {exchanged(n, m), exchanged(m, n), snake(m), snake(n), staggered(m), staggered(n)};
}

}  // namespace

ViewMisfit misfitOf(const View& view) {
  if (view.corners.size() < fewest_corners) return {};
  return misfitOf(pairsOf(view));
}

std::string numberingThatFits(const std::vector<const View*>& views) {
  const auto grid = latticeOf(views);
  if (!grid) return "";
  std::string best;
  std::vector<double> as_stated;
  for (const View* view : views) as_stated.push_back(misfitOf(*view).part());
  double least = std::min(smooth, 0.25 * medianOf(as_stated));
  for (const Renumbering& renumbering : renumberings(*grid)) {
    std::vector<double> parts, distances;
    for (const View* view : views) {
      std::vector<const Corner*> corners;
      for (const Corner& corner : view->corners) corners.push_back(&corner);
      std::sort(corners.begin(), corners.end(),
                [](const Corner* a, const Corner* b) { return a->number < b->number; });
      const bool is_whole = int(corners.size()) == grid->count();
      Pairs pairs;
      for (std::size_t k = 0; k < corners.size(); ++k) {
        const int index = is_whole ? int(k) : corners[k]->number - 1;  // files count from 1
        pairs.board.push_back(renumbering.place(std::max(index, 0)));
        pairs.pixels.push_back(corners[k]->pixel);
      }
      if (pairs.board.size() < fewest_corners || onLineButOne(pairs.board, 1e-4)) continue;
      const ViewMisfit misfit = misfitOf(pairs);
      parts.push_back(misfit.part());
      distances.push_back(misfit.px);
    }
    if (parts.empty() || !(medianOf(parts) < least)) continue;
    least = medianOf(parts);
    best = fmt::format("{} they fit to {} px", renumbering.name, twoDigits(medianOf(distances)));
  }
  return best;
}

void requireSmoothViews(const CameraData& camera) {
  constexpr std::size_t most_views = 12;  // to check
  constexpr double nearly_all = 0.8;
  std::vector<const View*> looked_at;
  std::vector<double> parts, distances;
  std::size_t not_smooth_ones = 0, hardly_smooth_ones = 0;
  const std::size_t step = (camera.views.size() + most_views - 1) / most_views;
  for (std::size_t i = 0; i < camera.views.size(); i += step) {
    if (camera.views[i].corners.size() < fewest_corners) continue;
    looked_at.push_back(&camera.views[i]);
    const ViewMisfit misfit = misfitOf(camera.views[i]);
    parts.push_back(misfit.part());
    distances.push_back(misfit.px);
    not_smooth_ones += exceeds(misfit, not_smooth) ? 1 : 0;
    hardly_smooth_ones += exceeds(misfit, hardly_smooth) ? 1 : 0;
  }
  const double enough = nearly_all * double(looked_at.size());
  if (looked_at.empty() || double(hardly_smooth_ones) < enough) return;
  const std::string numbering = numberingThatFits(looked_at);
  // Very wide lenses, too, leave some images hardly smooth. Then another numbering that fits is the proof.
  if (numbering.empty() && double(not_smooth_ones) < enough) return;
  throw DataError(
      "slom.calibration.bad-view",
      {.place = nameOf(camera),
       .fault = fmt::format(
           "in {} of {} images, corners and world points fit no lens and no plane: most are {} px off, "
           "{:.0f} % of the size of the board{}{}",
           hardly_smooth_ones, looked_at.size(), twoDigits(medianOf(distances)), 100 * medianOf(parts),
           numbering.empty() ? "" : "; ", numbering),
       .remedy = numbering.empty()
                     ? "number corners and world points in the same order, and check that the board has the "
                       "stated kind and size"
                     : "correct the world points, or the size of the board"});
}

}  // namespace slom::calibration
