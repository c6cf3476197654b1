#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <fmt/format.h>

#include "slom/calibration/board.hpp"
#include "slom/calibration/error.hpp"

namespace slom::calibration {

BoardPlane fitPlane(const std::vector<Corner>& corners) {
  if (corners.size() < 3) {
    throw DataError("slom.calibration.bad-view",
                    fmt::format("too few corners for a plane: {}; pass at least 3", corners.size()),
                    "corners");
  }
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const Corner& corner : corners) centre += corner.world / double(corners.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Corner& corner : corners) {
    const Eigen::Vector3d d = corner.world - centre;
    scatter += d * d.transpose() / double(corners.size());
  }
  if (!scatter.allFinite()) {
    throw DataError(
        "slom.calibration.bad-corner",
        fmt::format("the corners do not lie in a plane, because their coordinates are not finite or "
                    "too large; give coordinates of magnitude {:g} m at most",
                    most_corner_m),
        "corners");
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(
      scatter);  // ascending eigenvalues: the normal comes first
  Eigen::Matrix3d axes;
  axes.col(0) = eigen.eigenvectors().col(2);
  axes.col(2) = eigen.eigenvectors().col(0);
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return {SE3(SO3(axes), vec3(centre)), std::sqrt(scatter.trace()),
          std::sqrt(std::max(0.0, eigen.eigenvalues()[0]))};
}

namespace {

/// Returns whether the points with these sums (x, y, xx, xy, yy) lie on a line.
bool onLine(const Eigen::Matrix<double, 5, 1>& sums, double count, double tolerance) {
  const Eigen::Matrix<double, 5, 1> mean = sums / count;
  Eigen::Matrix2d scatter;
  scatter << mean[2] - mean[0] * mean[0], mean[3] - mean[0] * mean[1],  //
      mean[3] - mean[0] * mean[1], mean[4] - mean[1] * mean[1];
  const Eigen::Vector2d squares = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(scatter).eigenvalues();
  return squares[0] <= tolerance * tolerance * squares[1];
}

}  // namespace

bool onLineButOne(const std::vector<vec2>& points, double tolerance) {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  for (const vec2& point : points) centre += point / double(points.size());
  if (points.size() <= 3) return true;
  using Sums = Eigen::Matrix<double, 5, 1>;
  const auto sums_of = [&](const vec2& point) {
    const Eigen::Vector2d d = point - centre;
    return Sums(d.x(), d.y(), d.x() * d.x(), d.x() * d.y(), d.y() * d.y());
  };
  Sums all = Sums::Zero();
  for (const vec2& point : points) all += sums_of(point);
  const double count = double(points.size());
  if (onLine(all, count, tolerance)) return true;
  for (const vec2& point : points) {
    if (onLine(all - sums_of(point), count - 1, tolerance)) return true;
  }
  return false;
}

}  // namespace slom::calibration
