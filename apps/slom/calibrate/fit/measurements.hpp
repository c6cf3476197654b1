// The measurement functions. They accept variables over any scalar.
#pragma once

#include <type_traits>

#include "calibrate/types.hpp"

namespace slom::app::calib {

template <class T>
using ScalarOf = typename std::decay_t<T>::scalar;

/// Where the reference camera sees a corner [px]. Any argument may be known.
struct CornerInLeft {
  static constexpr bool is_vectorized = true;
  auto operator()(const auto& camera, const auto& left2world, const auto& corner) const {
    return camera.project(left2world.orient.inverse() * (corner - left2world.pos));
  }
};

/// Where another camera sees a corner [px].
struct CornerInOther {
  static constexpr bool is_vectorized = true;
  auto operator()(const auto& camera, const auto& left2camera, const auto& left2world,
                  const auto& corner) const {
    return camera.project(left2camera * (left2world.orient.inverse() * (corner - left2world.pos)));
  }
};

/// Gravity in a reading, seen in the world, minus gravity; the z axis of the world is vertical [m/s^2].
inline constexpr auto gravity_in_reading = [](const auto& left2world, const auto& left2imu,
                                              const auto& acc_bias, const auto& gravity, const vec3& acc) {
  using S = ScalarOf<decltype(left2world)>;
  const mtk::vect<3, S> acc_in_imu(acc.template cast<S>() - acc_bias);
  mtk::vect<3, S> difference = left2world.orient * (left2imu.inverse() * acc_in_imu);
  difference[2] -= gravity;
  return difference;
};

}  // namespace slom::app::calib
