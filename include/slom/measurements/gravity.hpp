/// The upward direction, and readings of an accelerometer at rest.
///
///     est.insertMeasurement(slom::GravityDirection(), orientation, up, slom::measured(mtk::S2<>(acc)), noise);
///     est.insertMeasurement(slom::Accelerometer(), orientation, up, g, bias, slom::measured(acc), noise);
///
///   variables  orientation  world_R_body, mtk::SO3<>, or a pose, whose orientation counts
///              up           mtk::S2<>, the world's upward direction; if that is the z axis, pass the constant
///                           mtk::S2<>(0, 0, 1)
///              g            magnitude of gravity [m/s^2]: a number or mtk::Scalar
///              bias         offset of the accelerometer, 3 [m/s^2], in its own frame
///              body2imu     imu_R_body, mtk::SO3<>: the mounting of the accelerometer on the body
///   source     Hertzberg et al., "Tutorial on Quick and Easy Model Fitting Using the SLoM Framework", 2012, section 2
/// Each of these may be a constant. An accelerometer at rest measures the force that supports it: +g upwards.
#pragma once

#include "mtk/types/s2.hpp"
#include "slom/measurements/point.hpp"

namespace slom {

/// Direction of gravity. Datum: mtk::S2<>, up in the body's frame. Residual: body_R_world up [-] z, 2 arcs [rad]. If
/// the datum points down, the variable points down, too.
struct GravityDirection {
  static constexpr bool is_vectorized = true;
  auto operator()(const auto& orientation, const auto& up) const {
    return detail::orientationOf(orientation).inverse() * up;
  }
};

/// Accelerometer at rest. Datum: the 3 readings [m/s^2]. Residual: body_R_world up g + bias - z, in the frame of the
/// accelerometer.
struct Accelerometer {
  static constexpr bool is_vectorized = true;
  auto operator()(const auto& orientation, const auto& up, const auto& g) const {
    return (detail::orientationOf(orientation).inverse() * up.vector()) * detail::numberOf(g);
  }
  auto operator()(const auto& orientation, const auto& up, const auto& g, const auto& bias) const {
    return (*this)(orientation, up, g) + bias;
  }
  auto operator()(const auto& orientation, const auto& body2imu, const auto& up, const auto& g,
                  const auto& bias) const {
    return body2imu * (*this)(orientation, up, g) + bias;
  }
};

}  // namespace slom
