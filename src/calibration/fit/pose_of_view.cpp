#include "calibration/fit/pose_of_view.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "calibration/cross_matrix.hpp"
#include "calibration/fit/single_camera.hpp"

namespace slom::calibration {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// The normal equations of a step: by translation, then by a turn on the left.
struct PoseEquations {
  Matrix6 H = Matrix6::Zero();
  Vector6 g = Vector6::Zero();
};

PoseEquations equationsAt(const Lens& lens, const View& view, const SE3& world2camera) {
  PoseEquations sum;
  for (const Corner& corner : view.corners) {
    const vec3 point(world2camera * corner.world);
    const Lens::PointProjection at = lens.differentiate(point);
    const Eigen::Vector2d e = at.pixel - corner.pixel;
    Eigen::Matrix<double, 2, 6> J;
    J << at.by_point, -at.by_point * crossMatrix(point);
    sum.H += J.transpose() * J, sum.g += J.transpose() * e;
  }
  return sum;
}

SE3 moved(const SE3& world2camera, const Vector6& step) {
  const SO3 turn = SO3::exp(vec3(Eigen::Vector3d(step.tail<3>())));
  return SE3(turn * world2camera.orient,
             vec3(turn * world2camera.pos + vec3(Eigen::Vector3d(step.head<3>()))));
}

}  // namespace

FittedPose fittedPose(const Lens& lens, const View& view, const SE3& start, Look look) {
  const int most_steps = look == Look::quick ? 12 : 40;
  const double tolerance = look == Look::quick ? 1e-3 : 1e-9;
  FittedPose best{start, squaredPixelError(lens, start, view)};
  double damping = 1e-4;
  for (int step = 0; step < most_steps && std::isfinite(best.square); ++step) {
    auto [H, g] = equationsAt(lens, view, best.world2camera);
    H.diagonal() *= 1 + damping;
    const SE3 next = moved(best.world2camera, -H.ldlt().solve(g));
    const double square = squaredPixelError(lens, next, view);
    if (square < best.square) {
      const bool is_done = best.square - square < tolerance * best.square;
      best = {next, square}, damping = std::max(1e-9, damping / 10);
      if (is_done) break;
    } else if ((damping *= 10) > 1e6) {
      break;
    }
  }
  return best;
}

}  // namespace slom::calibration
