#include "calibration/initialization/far_off.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include <Eigen/Geometry>

#include "calibration/initialization/plane_view.hpp"
#include "calibration/median.hpp"

namespace slom::calibration {
namespace {

constexpr std::size_t fewest_corners_asked = 12;  // in a view that is checked
constexpr double least_far_off_px = 20;
constexpr double
    suspicious = 5,
    far = 30;  // times the median distance from the least squares homography, and from the robust one
constexpr double least_median_px = 0.1;
constexpr int samples =
    60;  // of four corners; with a tenth of the corners wrong, the chance that each sample has a wrong one is 10^-28
constexpr double most = 0.1;  // fraction of the corners of a view

std::vector<double> distances(const PlaneView& view, const Eigen::Matrix3d& H) {
  std::vector<double> all;
  for (std::size_t i = 0; i < view.board.size(); ++i) {
    const double distance = ((H * view.board[i].homogeneous()).hnormalized() - view.pixels[i]).norm();
    all.push_back(std::isfinite(distance) ? distance : std::numeric_limits<double>::infinity());
  }
  return all;
}

/// Returns the distances from the homography whose median distance is smallest, among many of four corners each. The
/// samples are the same on all machines.
std::vector<double> robustDistances(const PlaneView& view) {
  std::mt19937 random(1);
  std::vector<double> best;
  double least = std::numeric_limits<double>::infinity();
  for (int sample = 0; sample < samples; ++sample) {
    std::vector<vec2> board, pixels;
    std::array<std::size_t, 4> chosen{};
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      do chosen[k] = random() % view.board.size();
      while (std::find(chosen.begin(), chosen.begin() + std::ptrdiff_t(k), chosen[k]) !=
             chosen.begin() + std::ptrdiff_t(k));
      board.push_back(view.board[chosen[k]]);
      pixels.push_back(view.pixels[chosen[k]]);
    }
    if (onLineButOne(board, 1e-3)) continue;
    std::vector<double> all = distances(view, findHomography(board, pixels));
    const double median = medianOf(all);
    if (median < least) least = median, best = std::move(all);
  }
  return best;
}

}  // namespace

std::vector<GrossCorner> farOffCorners(const Dataset& data) {
  std::vector<GrossCorner> found;
  for (std::size_t c = 0; c < data.cameras.size(); ++c) {
    for (const View& view : data.cameras[c].views) {
      if (view.corners.size() < fewest_corners_asked) continue;
      const PlaneView plane(view);
      const std::vector<double> fitted = distances(plane, plane.homography);
      const double largest = *std::max_element(fitted.begin(), fitted.end());
      if (!(largest > std::max(least_far_off_px, suspicious * medianOf(fitted)))) continue;
      const std::vector<double> robust = robustDistances(plane);
      if (robust.empty()) continue;
      const double median = std::max(medianOf(robust), least_median_px);
      std::vector<GrossCorner> own;
      for (std::size_t i = 0; i < robust.size(); ++i) {
        if (!(robust[i] > std::max(least_far_off_px, far * median))) continue;
        const Corner& corner = view.corners[i];
        const double noise =
            median /
            std::sqrt(2 * std::log(2.0));  // of u and of v, from distances with a Rayleigh distribution
        own.push_back({c, view.image, corner.number, corner.line, robust[i], robust[i], robust[i] / noise,
                       data.cameras[c].place(view, corner)});
      }
      if (double(own.size()) <= most * double(view.corners.size()))
        found.insert(found.end(), own.begin(), own.end());
    }
  }
  return found;
}

}  // namespace slom::calibration
