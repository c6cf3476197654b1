// The measurement functions.
#pragma once

#include <cstddef>
#include <type_traits>
#include <vector>

#include <slom/slom.hpp>

#include "calibration/cross_matrix.hpp"
#include "calibration/models/lens.hpp"
#include "slom/calibration/dataset.hpp"
#include "slom/calibration/types.hpp"

namespace slom::calibration {

/// Computes the pixel of a corner in a camera [px], for any scalar.
struct CornerInOther {
  auto operator()(const auto& camera, const auto& left2camera, const auto& left2world,
                  const auto& corner) const {
    return camera.project(left2camera * (left2world.orient.inverse() * (corner - left2world.pos)));
  }
};

/// Computes the Jacobian of the pixels of points [px], two rows for each: `point_of(i)` in the world, i < count.
/// Skips blocks that are a nullptr. Rotations are perturbed on the right, and translation comes before rotation.
template <class PointOf, class ByCamera, class ByLeft2Camera, class ByLeft2World>
void differentiatePixels(const Lens& camera, const SE3& left2camera, const SE3& left2world, std::size_t count,
                         const PointOf& point_of, ByCamera by_camera, ByLeft2Camera by_left2camera,
                         ByLeft2World by_left2world) {
  const Eigen::Matrix3d R = left2camera.orient.toRotationMatrix();
  const Eigen::Matrix3d world2left = left2world.orient.toRotationMatrix().transpose();
  const Eigen::Vector3d origin = left2world.pos, offset = left2camera.pos;
  for (std::size_t i = 0; i < count; ++i) {
    const auto row = 2 * Eigen::Index(i);
    const Eigen::Vector3d in_left = world2left * (point_of(i) - origin);
    const auto d = camera.differentiate(R * in_left + offset);
    const Eigen::Matrix<double, 2, 3> by_left = d.by_point * R;
    const Eigen::Matrix<double, 2, 3> by_turn = by_left * crossMatrix(in_left);
    if constexpr (!std::is_null_pointer_v<ByCamera>) by_camera->template middleRows<2>(row) = d.by_parameters;
    if constexpr (!std::is_null_pointer_v<ByLeft2Camera>) {
      by_left2camera->template block<2, 3>(row, 0) = d.by_point;
      by_left2camera->template block<2, 3>(row, 3) = -by_turn;
    }
    if constexpr (!std::is_null_pointer_v<ByLeft2World>) {
      by_left2world->template block<2, 3>(row, 0).noalias() = -by_left * world2left;
      by_left2world->template block<2, 3>(row, 3) = by_turn;
    }
  }
}

/// The corners of the board in one image of a camera, as one measurement: differences between predicted and found
/// pixels, divided by Corner::sigma [px]. Takes all corners of a view, or every `step`-th. The corners must outlive
/// this object.
class CornersOfView {
 public:
  explicit CornersOfView(const View& view, std::size_t first = 0, std::size_t step = 1)
      : corners_(&view.corners), first_(first), step_(step) {}

  Eigen::VectorXd operator()(const Lens& camera, const SE3& left2camera, const SE3& left2world) const {
    const Eigen::Matrix3d R = (left2camera.orient * left2world.orient.inverse()).toRotationMatrix();
    const Eigen::Vector3d offset = left2camera.pos - R * left2world.pos;
    Eigen::VectorXd difference(2 * Eigen::Index(count()));
    for (std::size_t i = 0; i < count(); ++i) {
      const vec3 point(R * corner(i).world + offset);
      difference.segment<2>(2 * Eigen::Index(i)) =
          (camera.project(point) - corner(i).pixel) / corner(i).sigma;
    }
    return difference;
  }

 protected:
  void differentiated(const Lens& camera, const SE3& left2camera, const SE3& left2world, auto by_camera,
                      auto by_left2camera, auto by_left2world) const {
    differentiatePixels(
        camera, left2camera, left2world, count(), [&](std::size_t i) { return corner(i).world; }, by_camera,
        by_left2camera, by_left2world);
    for (std::size_t i = 0; i < count(); ++i) {
      if (corner(i).sigma == 1) continue;
      const auto row = 2 * Eigen::Index(i);
      const auto divide = [&](auto block) {
        if constexpr (!std::is_null_pointer_v<decltype(block)>)
          block->template middleRows<2>(row) /= corner(i).sigma;
      };
      divide(by_camera), divide(by_left2camera), divide(by_left2world);
    }
  }

 private:
  std::size_t count() const { return (corners_->size() - first_ + step_ - 1) / step_; }
  const Corner& corner(std::size_t i) const { return (*corners_)[first_ + i * step_]; }

  const std::vector<Corner>* corners_;
  std::size_t first_, step_;
};

/// Corners seen by the reference camera. The camera may be known.
struct ViewOfLeft : CornersOfView {
  using CornersOfView::CornersOfView;
  Eigen::VectorXd operator()(const Lens& camera, const SE3& left2world) const {
    return CornersOfView::operator()(camera, SE3(), left2world);
  }
  void jacobian(const Lens& camera, const SE3& left2world, auto& by_camera, auto& by_left2world) const {
    differentiated(camera, SE3(), left2world, &by_camera, nullptr, &by_left2world);
  }
  void jacobian(const Lens& camera, const SE3& left2world, auto& by_left2world) const {
    differentiated(camera, SE3(), left2world, nullptr, nullptr, &by_left2world);
  }
};

/// Corners seen by another camera. The camera and left2camera may be known.
struct ViewOfOther : CornersOfView {
  using CornersOfView::CornersOfView;
  void jacobian(const Lens& camera, const SE3& left2camera, const SE3& left2world, auto& by_camera,
                auto& by_left2camera, auto& by_left2world) const {
    differentiated(camera, left2camera, left2world, &by_camera, &by_left2camera, &by_left2world);
  }
  void jacobian(const Lens& camera, const SE3& left2camera, const SE3& left2world,
                auto& by_left2world) const {
    differentiated(camera, left2camera, left2world, nullptr, nullptr, &by_left2world);
  }
};

/// Returns gravity from a reading, in the world, minus gravity; the z axis of the world is vertical [m/s^2].
vec3 gravityResidual(const SE3& left2world, const SO3& left2imu, const vec3& acc_bias, double gravity,
                     const vec3& acc);
/// Inserts gravityResidual() as a measurement.
void insertReading(Estimator& estimator, const VarID<SE3>& left2world, const VarID<SO3>& left2imu,
                   const VarID<vec3>& acc_bias, const VarID<mtk::Scalar<>>& gravity, const vec3& acc,
                   double sigma_acc);

}  // namespace slom::calibration
