// A condensed view, or a band of its rows, as a measurement at a time that depends on the clock and the shutter of its
// camera.
//   t = stamp - offset + line_delay * row, in the clock of the reference camera [s]
#pragma once

#include <utility>

#include "calibration/streams/splines/view_on_spline.hpp"

namespace slom::calibration {

/// When a camera sees a corner: `stamp` of the image in the clock of the camera [s], row of the corner [px].
struct RowTime {
  double stamp = 0, row = 0;

  /// Returns the time in the clock of the reference camera.
  double at(double offset, double line_delay) const { return stamp - offset + line_delay * row; }
};

/// A view on a segment, at any time. Beyond the knots, the polynomials of the segment continue.
///   variables  control points, lens, left2camera (of all cameras but the reference), offset [s], line_delay [s/row]
template <class Controls>
class ViewInTimeOnSegment;
template <std::size_t... K>
class ViewInTimeOnSegment<std::index_sequence<K...>> : RowsOnSegment<std::index_sequence<K...>> {
  using Rows = RowsOnSegment<std::index_sequence<K...>>;
  using Controls = std::array<SE3, pose_order>;
  using Scalar = mtk::Scalar<>;
  template <std::size_t k>
  using Control = typename Rows::template Control<k>;

 public:
  using typename Rows::Vector6;
  ViewInTimeOnSegment(std::shared_ptr<const CondensedView> view,
                      const trajectory::Blending<pose_order>& blending, const RowTime& time)
      : Rows(std::move(view)), blending_(blending), time_(time) {}

  Vector6 operator()(const Control<K>&... controls, const Lens& lens, const Scalar& offset,
                     const Scalar& line_delay) const {
    return this->rowsAt(segmentAt(offset, line_delay).poseOf({controls...}), lens);
  }
  Vector6 operator()(const Control<K>&... controls, const Lens& lens, const SE3& left2camera,
                     const Scalar& offset, const Scalar& line_delay) const {
    return this->rowsAt(segmentAt(offset, line_delay).poseOf({controls...}), lens, left2camera);
  }
  void jacobian(const Control<K>&... controls, const Lens&, const Scalar& offset, const Scalar& line_delay,
                auto&... by) const {
    differentiateInTime({controls...}, offset, line_delay, by...);
  }
  void jacobian(const Control<K>&... controls, const Lens&, const SE3& left2camera, const Scalar& offset,
                const Scalar& line_delay, auto&... by) const {
    differentiateInTime({controls...}, offset, line_delay, by...);
    std::get<sizeof...(K) + 1>(std::tie(by...)) = this->byLeft2Camera(left2camera);
  }

 private:
  double timeAt(const Scalar& offset, const Scalar& line_delay) const {
    return time_.at(double(offset), double(line_delay));
  }
  PoseOnSegment segmentAt(const Scalar& offset, const Scalar& line_delay) const {
    return {blending_, timeAt(offset, line_delay)};
  }
  /// Sets all blocks but that of left2camera. The last two are those of offset and line delay.
  void differentiateInTime(const Controls& controls, const Scalar& offset, const Scalar& line_delay,
                           auto&... by) const {
    const PoseOnSegment segment = segmentAt(offset, line_delay);
    this->differentiated(segment, controls, by...);
    const trajectory::PoseSegment<pose_order> motion(blending_, controls);
    const double time = timeAt(offset, line_delay);
    const CondensedView::Matrix6 by_pose = this->byLeft2World(segment.poseOf(controls));
    const Vector6 by_time = by_pose.template leftCols<3>() * motion.velocityAt(time) +
                            by_pose.template rightCols<3>() * motion.angularVelocityAt(time);
    const auto blocks = std::tie(by...);
    std::get<sizeof...(by) - 2>(blocks) = -by_time;
    std::get<sizeof...(by) - 1>(blocks) = time_.row * by_time;
  }

  trajectory::Blending<pose_order> blending_;
  RowTime time_;
};
using ViewInTime = ViewInTimeOnSegment<std::make_index_sequence<pose_order>>;

}  // namespace slom::calibration
