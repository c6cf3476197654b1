// A condensed view as a measurement: of the pose at an image or of the control points around its time, of the lens, and of
// the camera on the rig.
#pragma once

#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>

#include <slom/slom.hpp>
#include <slom/trajectory.hpp>

#include "calibration/cross_matrix.hpp"
#include "calibration/streams/splines/condensed_view.hpp"

namespace slom::calibration {

/// Order of the splines of poses: forces are then polynomials of degree 3 between knots.
inline constexpr int pose_order = 6;
using RigSpline = trajectory::PoseSpline<pose_order>;

/// Returns the inverse of the right Jacobian of SO(3): log(exp(v) exp(d)) = v + J^-1 d, to first order of d.
inline Eigen::Matrix3d inverseRightJacobianOf(const Eigen::Vector3d& v) {
  const double angle = v.norm(), squared = angle * angle;
  const double factor = angle < 1e-3 ? 1. / 12 + squared / 720
                                     : 1 / squared - (1 + std::cos(angle)) / (2 * angle * std::sin(angle));
  const Eigen::Matrix3d cross = crossMatrix(v);
  return Eigen::Matrix3d::Identity() + cross / 2 + factor * cross * cross;
}

/// The rows of a condensed view for a given pose.
class ViewRows {
 public:
  using Vector6 = CondensedView::Vector6;

  explicit ViewRows(std::shared_ptr<const CondensedView> view) : view_(std::move(view)) {}

 protected:
  Vector6 rowsAt(const SE3& left2world, const Lens& lens) const {
    return view_->rest + view_->by_left2world * changeOf(left2world, view_->left2world) +
           view_->by_lens * (lens - view_->lens);
  }
  Vector6 rowsAt(const SE3& left2world, const Lens& lens, const SE3& left2camera) const {
    return rowsAt(left2world, lens) + view_->by_left2camera * changeOf(left2camera, view_->left2camera);
  }
  CondensedView::Matrix6 byLeft2World(const SE3& now) const {
    return chained(view_->by_left2world, now, view_->left2world);
  }
  const Eigen::MatrixXd& byLens() const { return view_->by_lens; }
  CondensedView::Matrix6 byLeft2Camera(const SE3& now) const {
    return chained(view_->by_left2camera, now, view_->left2camera);
  }

 private:
  static Vector6 changeOf(const SE3& now, const SE3& before) {
    Vector6 change;
    change << now.pos - before.pos, SO3::log(before.orient.inverse() * now.orient);
    return change;
  }
  static CondensedView::Matrix6 chained(CondensedView::Matrix6 by_change, const SE3& now, const SE3& before) {
    by_change.rightCols<3>() *= inverseRightJacobianOf(SO3::log(before.orient.inverse() * now.orient));
    return by_change;
  }

  std::shared_ptr<const CondensedView> view_;
};

/// A view at a pose of its own.
struct ViewAtPose : ViewRows {
  using ViewRows::ViewRows;
  Vector6 operator()(const SE3& left2world, const Lens& lens) const { return rowsAt(left2world, lens); }
  Vector6 operator()(const SE3& left2world, const Lens& lens, const SE3& left2camera) const {
    return rowsAt(left2world, lens, left2camera);
  }
  void jacobian(const SE3& left2world, const Lens&, auto& by_left2world, auto& by_lens) const {
    by_left2world = byLeft2World(left2world);
    by_lens = byLens();
  }
  void jacobian(const SE3& left2world, const Lens&, const SE3& left2camera, auto& by_left2world,
                auto& by_lens, auto& by_left2camera) const {
    by_left2world = byLeft2World(left2world);
    by_lens = byLens();
    by_left2camera = byLeft2Camera(left2camera);
  }
};

/// The pose of a spline at one time, with its derivatives by the control points of the segment.
class PoseOnSegment {
 public:
  PoseOnSegment(const trajectory::Blending<pose_order>& blending, double time) : steps_(blending.at(time)) {}

  SE3 poseOf(const std::array<SE3, pose_order>& controls) const {
    SE3 pose = controls[0];
    for (std::size_t j = 0; j < steps_.size(); ++j)
      pose.pos += vec3(steps_[j] * (controls[j + 1].pos - controls[j].pos));
    pose.orient = controls[0].orient * recursionOf(controls).turn(steps_);
    return pose;
  }
  /// Calls each(k, weight, by_turn) with the derivatives by control point k: weight I of position by position, by_turn
  /// of rotation by rotation, both perturbed on the right.
  void eachDerivative(const std::array<SE3, pose_order>& controls, auto&& each) const {
    const auto recursion = recursionOf(controls);
    const auto turn = recursion.turnWithDerivatives(steps_);
    for (std::size_t k = 0; k < controls.size(); ++k) {
      const double weight = (k == 0 ? 1 : steps_[k - 1]) - (k < steps_.size() ? steps_[k] : 0);
      Eigen::Matrix3d by_turn = recursion.byControl(turn.by_step, k);
      if (k == 0) by_turn += turn.turn.inverse().toRotationMatrix();
      each(k, weight, by_turn);
    }
  }

 private:
  static trajectory::detail::RotationRecursion<pose_order, double> recursionOf(
      const std::array<SE3, pose_order>& controls) {
    std::array<SO3, pose_order> rotations;
    for (std::size_t k = 0; k < controls.size(); ++k) rotations[k] = controls[k].orient;
    return trajectory::detail::RotationRecursion<pose_order, double>(rotations);
  }

  std::array<double, pose_order - 1> steps_;
};

/// The rows of a view by the control points of a segment.
template <class Controls>
class RowsOnSegment;
template <std::size_t... K>
class RowsOnSegment<std::index_sequence<K...>> : protected ViewRows {
 protected:
  template <std::size_t>
  using Control = SE3;
  using ViewRows::ViewRows;

  /// Sets the blocks of the control points and of the lens.
  void differentiated(const PoseOnSegment& segment, const std::array<SE3, pose_order>& controls,
                      auto&... by) const {
    const auto blocks = std::tie(by...);
    const CondensedView::Matrix6 by_pose = byLeft2World(segment.poseOf(controls));
    const auto set = [&](auto& block, double weight, const Eigen::Matrix3d& by_turn) {
      block.template leftCols<3>() = weight * by_pose.template leftCols<3>();
      block.template rightCols<3>() = by_pose.template rightCols<3>() * by_turn;
    };
    segment.eachDerivative(controls, [&](std::size_t k, double weight, const Eigen::Matrix3d& by_turn) {
      ((k == K ? set(std::get<K>(blocks), weight, by_turn) : void()), ...);
    });
    std::get<sizeof...(K)>(blocks) = byLens();
  }
};

/// A view at a time on a spline.
template <class Controls>
class ViewOnSegment;
template <std::size_t... K>
class ViewOnSegment<std::index_sequence<K...>> : RowsOnSegment<std::index_sequence<K...>> {
  using Rows = RowsOnSegment<std::index_sequence<K...>>;
  template <std::size_t k>
  using Control = typename Rows::template Control<k>;

 public:
  using typename Rows::Vector6;
  ViewOnSegment(std::shared_ptr<const CondensedView> view, const PoseOnSegment& segment)
      : Rows(std::move(view)), segment_(segment) {}

  Vector6 operator()(const Control<K>&... controls, const Lens& lens) const {
    return this->rowsAt(segment_.poseOf({controls...}), lens);
  }
  Vector6 operator()(const Control<K>&... controls, const Lens& lens, const SE3& left2camera) const {
    return this->rowsAt(segment_.poseOf({controls...}), lens, left2camera);
  }
  void jacobian(const Control<K>&... controls, const Lens&, auto&... by) const {
    this->differentiated(segment_, {controls...}, by...);
  }
  void jacobian(const Control<K>&... controls, const Lens&, const SE3& left2camera, auto&... by) const {
    this->differentiated(segment_, {controls...}, by...);
    std::get<sizeof...(K) + 1>(std::tie(by...)) = this->byLeft2Camera(left2camera);
  }

 private:
  PoseOnSegment segment_;
};
using ViewOnSpline = ViewOnSegment<std::make_index_sequence<pose_order>>;

/// The rows on a lens alone, as a measurement.
class RowsOfLens {
 public:
  explicit RowsOfLens(std::shared_ptr<const LensRows> rows) : rows_(std::move(rows)) {}
  Eigen::VectorXd operator()(const Lens& lens) const {
    return rows_->byLens() * (lens - rows_->lens()) + rows_->rest();
  }
  void jacobian(const Lens&, auto& by_lens) const { by_lens = rows_->byLens(); }

 private:
  std::shared_ptr<const LensRows> rows_;
};

}  // namespace slom::calibration
