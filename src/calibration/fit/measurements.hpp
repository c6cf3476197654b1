// The measurement functions.
#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>
#include <vector>

#include <slom/slom.hpp>

#include "calibration/fit/seen_board.hpp"
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

  /// Returns the derivative of the differences by the readout of the camera (Corner::by_readout).
  Eigen::VectorXd byReadout() const {
    Eigen::VectorXd all(2 * Eigen::Index(count()));
    for (std::size_t i = 0; i < count(); ++i)
      all.segment<2>(2 * Eigen::Index(i)) = corner(i).by_readout / corner(i).sigma;
    return all;
  }

 protected:
  /// Sets the blocks of the Jacobian that are not a nullptr.
  void differentiated(const Lens& camera, const SE3& left2camera, const SE3& left2world, auto by_camera,
                      auto by_left2camera, auto by_left2world) const {
    const SeenBoard board(camera, left2camera, left2world);
    for (std::size_t i = 0; i < count(); ++i) {
      const SeenBoard::Rows rows = board.rowsOf(corner(i).world);
      const auto row = 2 * Eigen::Index(i);
      if constexpr (!std::is_null_pointer_v<decltype(by_camera)>)
        by_camera->template middleRows<2>(row) = rows.seen.by_parameters;
      if constexpr (!std::is_null_pointer_v<decltype(by_left2camera)>) {
        by_left2camera->template block<2, 3>(row, 0) = rows.seen.by_point;
        by_left2camera->template block<2, 3>(row, 3) = -rows.by_turn;
      }
      if constexpr (!std::is_null_pointer_v<decltype(by_left2world)>) {
        by_left2world->template block<2, 3>(row, 0) = -rows.by_point;
        by_left2world->template block<2, 3>(row, 3) = rows.by_turn;
      }
      if (corner(i).sigma == 1) continue;
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

/// Corners of a camera whose rows are read one after another: a measurement of corners that depends on the readout, too,
/// as its first variable. Each corner has moved by readout * Corner::by_readout when its row is read.
template <class Corners>
class WithReadout {
 public:
  explicit WithReadout(const Corners& corners) : corners_(corners), by_readout_(corners.byReadout()) {}

  auto operator()(const mtk::Scalar<>& readout, const auto&... variables) const {
    auto difference = corners_(variables...);
    difference += double(readout) * by_readout_;
    return difference;
  }
  void jacobian(const mtk::Scalar<>&, const Lens& a, const auto& b, auto& by_readout, auto& by_a,
                auto& by_b) const {
    by_readout = by_readout_;
    corners_.jacobian(a, b, by_a, by_b);
  }
  void jacobian(const mtk::Scalar<>&, const Lens& a, const auto& b, const auto& c, auto& by_readout,
                auto& by_a, auto& by_b, auto& by_c) const {
    by_readout = by_readout_;
    corners_.jacobian(a, b, c, by_a, by_b, by_c);
  }
  void jacobian(const mtk::Scalar<>&, const Lens& a, const auto& b, const auto& c, const auto& d,
                auto& by_readout, auto& by_a, auto& by_b, auto& by_c, auto& by_d) const {
    by_readout = by_readout_;
    corners_.jacobian(a, b, c, d, by_a, by_b, by_c, by_d);
  }

 private:
  Corners corners_;
  decltype(std::declval<const Corners&>().byReadout()) by_readout_;
};

/// Returns gravity from a reading, in the world, minus gravity; the z axis of the world is vertical [m/s^2].
vec3 gravityResidual(const SE3& left2world, const SO3& left2imu, const vec3& acc_bias, double gravity,
                     const vec3& acc);
/// Inserts gravityResidual() as a measurement.
void insertReading(Estimator& estimator, const VarID<SE3>& left2world, const VarID<SO3>& left2imu,
                   const VarID<vec3>& acc_bias, const VarID<mtk::Scalar<>>& gravity, const vec3& acc,
                   double sigma_acc);

}  // namespace slom::calibration
