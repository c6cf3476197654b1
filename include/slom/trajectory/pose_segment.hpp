/// PoseSegment: one segment of a trajectory of poses whose position and orientation are splines of their own, with
/// common knots: x(t) in R^3 and R(t) on SO(3).
/// The pose is world_T_body. Names without a frame: positions, velocities and accelerations are along the axes of the
/// world, angular ones along those of the body.
///   source  Ovren and Forssen, "Trajectory representation and landmark projection for continuous-time structure from
///           motion", 2019, compare it with a spline on SE(3)
#pragma once

#include <array>

#include "mtk/types/trafo.hpp"
#include "slom/trajectory/rotation_segment.hpp"
#include "slom/trajectory/vector_segment.hpp"

namespace slom::trajectory {

/// The functions of time of a body whose position and orientation are curves of their own.
template <class Position, class Rotation>
class PoseFunctions {
 public:
  /// Returns world_T_body at the time t.
  template <class Time>
  auto poseAt(const Time& t) const {
    return mtk::detail::joined(orientationAt(t), positionAt(t));
  }
  /// Returns the position of the body in the world.
  template <class Time>
  auto positionAt(const Time& t) const {
    return position_.at(t);
  }
  /// Returns the rotation from the body to the world.
  template <class Time>
  auto orientationAt(const Time& t) const {
    return rotation_.orientationAt(t);
  }
  /// Returns the derivative of the position by time.
  template <class Time>
  auto velocityAt(const Time& t) const {
    return position_.velocityAt(t);
  }
  /// Returns the second derivative of the position by time.
  template <class Time>
  auto accelerationAt(const Time& t) const {
    return position_.accelerationAt(t);
  }
  /// Returns the velocity along the axes of the body.
  template <class Time>
  auto bodyVelocityAt(const Time& t) const {
    return orientationAt(t).inverse() * velocityAt(t);
  }
  /// Returns the acceleration along the axes of the body. An accelerometer in the origin of the body reads this vector
  /// minus gravity along the same axes.
  template <class Time>
  auto bodyAccelerationAt(const Time& t) const {
    return orientationAt(t).inverse() * accelerationAt(t);
  }
  /// Returns the angular velocity in the frame of the body, as a gyroscope reads it.
  template <class Time>
  auto angularVelocityAt(const Time& t) const {
    return rotation_.angularVelocityAt(t);
  }
  /// Returns the derivative by time of angularVelocityAt, in the frame of the body.
  template <class Time>
  auto angularAccelerationAt(const Time& t) const {
    return rotation_.angularAccelerationAt(t);
  }
  /// Returns angular velocity and acceleration in the frame of the body together.
  template <class Time>
  auto angularMotionAt(const Time& t) const {
    return rotation_.angularMotionAt(t);
  }
  /// Returns the angular velocity along the axes of the world.
  template <class Time>
  auto worldAngularVelocityAt(const Time& t) const {
    return rotation_.worldAngularVelocityAt(t);
  }
  /// Returns the angular acceleration along the axes of the world.
  template <class Time>
  auto worldAngularAccelerationAt(const Time& t) const {
    return rotation_.worldAngularAccelerationAt(t);
  }

 protected:
  /// Joins the two curves.
  PoseFunctions(const Position& position, const Rotation& rotation)
      : position_(position), rotation_(rotation) {}

  Position position_;
  Rotation rotation_;
};

/// The N control points of a segment, of numbers S. Times may be of another number type than S.
template <int N, class S = double>
class PoseSegment : public PoseFunctions<VectorSegment<3, N, S>, RotationSegment<N, S>> {
  using Position = VectorSegment<3, N, S>;
  using Rotation = RotationSegment<N, S>;

 public:
  static constexpr int order = N;
  using Control = mtk::trafo<mtk::SO3<S>>;
  using Controls = std::array<Control, std::size_t{N}>;
  /// This segment over another number type.
  template <class T>
  using Over = PoseSegment<N, T>;

  /// Joins control points and weights.
  PoseSegment(const Blending<N>& blending, const Controls& controls)
      : PoseFunctions<Position, Rotation>(Position(blending, positionsOf(controls)),
                                          Rotation(blending, detail::orientationsOf(controls))) {}

  /// Returns the weights of the segment.
  const Blending<N>& blending() const { return this->position_.blending(); }

 private:
  static typename Position::Controls positionsOf(const Controls& controls) {
    typename Position::Controls result;
    for (std::size_t j = 0; j < controls.size(); ++j) result[j] = controls[j].pos;
    return result;
  }
};

}  // namespace slom::trajectory
