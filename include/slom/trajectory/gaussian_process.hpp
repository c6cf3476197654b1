/// GaussianProcess: a trajectory whose states are variables of an estimator, with a prior of smooth motion.
///
///     using namespace slom::trajectory;
///     PoseProcess<WhiteNoise::on_jerk> pose(Knots(0, 0.1), poseDensity(100, 50), "pose");
///     pose.extend(est, 0, 60);                                 // states at 0, 0.1, ..., and the prior between them
///     ...                                                      // insertMeasurement and optimize as on splines
///     const auto where = pose.segmentAt(12.5).poseAt(12.5);    // the mean between two states
///
/// The knots are the times of the states. A measurement at another time depends on the two states around it, by the mean
/// between them: the noise of the motion within the segment is neglected. For a time T between the states and a power
/// spectral density q, the neglected variance is at most
///   white noise on acceleration    q T^3 / 192 of the value, q T / 12 of the velocity
///   white noise on jerk            q T^5 / 20480 of the value, q T^3 / 1500 of the velocity, q T / 16 of the acceleration
/// Choose T such that these are small against the variances of the measurements in a segment together.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "slom/trajectory/process_segment.hpp"
#include "slom/trajectory/spline.hpp"

namespace slom::trajectory {

/// A process with segments of this kind: VectorProcessSegment, RotationProcessSegment or PoseProcessSegment. A cheap
/// handle with the functions of Spline; its control points are the states.
template <class Segment>
class GaussianProcess : public Spline<Segment> {
  using State = typename Spline<Segment>::State;

 public:
  using Density = typename Segment::Prior::Density;

  /// Creates a process without states. `density`: power spectral density of the white noise [unit^2 / s^3 on
  /// acceleration, unit^2 / s^5 on jerk] of each component: of a vector; of an angular motion about the axes of the
  /// body [unit: rad]; of a pose along the axes of the world, then about those of the body. Throws [slom.bad-density]
  /// unless all are positive and finite.
  GaussianProcess(Knots knots, const Density& density, std::string name)
      : Spline<Segment>(std::make_shared<State>(std::move(knots), std::move(name), checked(density))) {}

 private:
  static const Density& checked(const Density& density) {
    detail::checkDensity(density.data(), static_cast<int>(density.size()));
    return density;
  }
};

/// A process in R^D.
template <int D, WhiteNoise W>
using VectorProcess = GaussianProcess<VectorProcessSegment<D, W>>;
/// A process on SO(3).
template <WhiteNoise W>
using RotationProcess = GaussianProcess<RotationProcessSegment<W>>;
/// A process of positions and one of orientations with common times of states.
template <WhiteNoise W>
using PoseProcess = GaussianProcess<PoseProcessSegment<W>>;

/// Returns the power spectral density of a pose that is equal along all axes: of the position [m^2 / s^3 or m^2 / s^5]
/// and of the orientation [rad^2 / s^3 or rad^2 / s^5].
inline mtk::vect<6> poseDensity(double position, double orientation) {
  return {position, position, position, orientation, orientation, orientation};
}

}  // namespace slom::trajectory
