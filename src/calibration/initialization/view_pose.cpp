#include "calibration/initialization/view_pose.hpp"

#include <limits>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "calibration/nearest_rotation.hpp"

namespace slom::calibration {

namespace {

/// Returns a pose of NaN if the matrix is not a rotation, for example after a homography that overflows.
SE3 poseOf(const Eigen::Matrix3d& R, const Eigen::Vector3d& t) {
  const double determinant = R.determinant();
  if (!(determinant > 0.5 && determinant < 2))
    return SE3(vec3(vec3::Constant(std::numeric_limits<double>::quiet_NaN())));
  return SE3(SO3(R), vec3(t));
}

}  // namespace

SE3 poseFromHomography(const PlaneView& view, const Pinhole& camera) {
  // The origin of the plane is the centre of the corners, so H(2,2) > 0 is its depth, up to scale.
  Eigen::Matrix3d M = camera.matrix().inverse() * view.homography;
  M *= 2 / (M.col(0).norm() + M.col(1).norm());
  const Eigen::Vector3d centre = M.col(2);
  M.col(2) = M.col(0).cross(M.col(1));
  return poseOf(nearestRotation(M), centre) * view.plane.plane2world.inverse();
}

SE3 tiltedOtherWay(const PlaneView& view, const SE3& world2camera) {
  const SE3 plane2camera = world2camera * view.plane.plane2world;
  const Eigen::Vector3d observation = plane2camera.pos.normalized();
  const Eigen::Matrix3d mirror = Eigen::Matrix3d::Identity() - 2 * observation * observation.transpose();
  Eigen::Matrix3d R = mirror * plane2camera.orient.toRotationMatrix();
  R.col(2) = -R.col(2);
  return poseOf(R, plane2camera.pos) * view.plane.plane2world.inverse();
}

double squaredPixelError(const PlaneView& view, const Pinhole& camera, const SE3& world2camera) {
  const SE3 plane2camera = world2camera * view.plane.plane2world;
  double sum = 0;
  for (std::size_t i = 0; i < view.board.size(); ++i) {
    const vec3 p = plane2camera * vec3(view.board[i].x(), view.board[i].y(), 0.);
    if (!(p.z() > 0)) return std::numeric_limits<double>::infinity();
    const vec2 pixel(camera.fx * p.x() / p.z() + camera.cx, camera.fy * p.y() / p.z() + camera.cy);
    sum += (pixel - view.pixels[i]).squaredNorm();
  }
  return sum;
}

}  // namespace slom::calibration
