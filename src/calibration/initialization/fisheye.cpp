#include "calibration/initialization/fisheye.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "calibration/initialization/view_pose.hpp"
#include "calibration/models/fisheye.hpp"
#include "slom/calibration/board.hpp"

namespace slom::calibration {
namespace {

constexpr double widest_angle =
    80 * std::numbers::pi / 180;  // a plane before the camera still has a usable size there
constexpr std::size_t least_corners = 4;

PlaneView flattened(const PlaneView& view, const Pinhole& lens) {
  PlaneView flat = view;
  flat.board.clear();
  flat.pixels.clear();
  for (std::size_t i = 0; i < view.pixels.size(); ++i) {
    const double x = (view.pixels[i].x() - lens.cx) / lens.fx, y = (view.pixels[i].y() - lens.cy) / lens.fy;
    const double angle = std::hypot(x, y);
    if (angle > widest_angle) continue;
    const double stretch = angle > 0 ? std::tan(angle) / angle : 1;
    flat.board.push_back(view.board[i]);
    flat.pixels.push_back(vec2(lens.fx * stretch * x + lens.cx, lens.fy * stretch * y + lens.cy));
  }
  if (flat.board.size() >= least_corners) {
    flat.homography = findHomography(flat.board, flat.pixels);
  } else {
    flat.homography.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  return flat;
}

/// Returns the sum of squared distances between pixels and predictions of an equidistant lens [px^2].
double squaredErrorAsFisheye(const std::vector<PlaneView>& views, const Pinhole& pinhole) {
  const Fisheye<> lens = Fisheye<>::fromPinhole(pinhole);
  double sum = 0;
  for (const PlaneView& view : views) {
    const PlaneView flat = flattened(view, pinhole);
    if (!flat.homography.allFinite()) return std::numeric_limits<double>::infinity();
    const SE3 plane2camera = poseFromHomography(flat, pinhole) * view.plane.plane2world;
    for (std::size_t i = 0; i < view.board.size(); ++i) {
      const vec3 point = plane2camera * vec3(view.board[i].x(), view.board[i].y(), 0.);
      sum += (lens.project(point) - view.pixels[i]).squaredNorm();
    }
  }
  return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
}

}  // namespace

std::vector<PlaneView> flattened(const std::vector<PlaneView>& views, const Pinhole& equidistant) {
  std::vector<PlaneView> flat;
  for (const PlaneView& view : views) flat.push_back(flattened(view, equidistant));
  return flat;
}

IntrinsicsStart startFisheye(const std::vector<PlaneView>& views) {
  Eigen::Vector2d low = views.front().pixels.front(), high = low;
  for (const PlaneView& view : views) {
    for (const vec2& pixel : view.pixels) low = low.cwiseMin(pixel), high = high.cwiseMax(pixel);
  }
  const Eigen::Vector2d centre = (low + high) / 2;
  const double extent = (high - low).maxCoeff();
  IntrinsicsStart best{{extent, extent, centre.x(), centre.y()},
                       "f found by trying, centre amid the corners"};
  double least = std::numeric_limits<double>::infinity();
  for (double f = 0.2 * extent; f < 20 * extent; f *= 1.1) {
    const Pinhole guess{f, f, centre.x(), centre.y()};
    const double error = squaredErrorAsFisheye(views, guess);
    if (error < least) best.pinhole = guess, least = error;
  }
  return best;
}

}  // namespace slom::calibration
