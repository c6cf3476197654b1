// The measurement functions: prediction minus measurement. They accept variables over any scalar.
#pragma once

#include <type_traits>

#include "calibrate/types.hpp"

namespace slom::app::calib {

template <class T>
using ScalarOf = typename std::decay_t<T>::scalar;

/// A corner in an image of the reference camera [px].
inline constexpr auto corner_in_left = [](const auto& camera, const auto& left2world, const vec3& corner,
                                          const vec2& pixel) {
  using S = ScalarOf<decltype(camera)>;
  return mtk::vect<2, S>(camera.project(left2world.inverse() * corner) - pixel.template cast<S>());
};

/// A corner in an image of another camera [px].
inline constexpr auto corner_in_other = [](const auto& camera, const auto& left2camera,
                                           const auto& left2world, const vec3& corner, const vec2& pixel) {
  using S = ScalarOf<decltype(camera)>;
  return mtk::vect<2, S>(camera.project(left2camera * (left2world.inverse() * corner)) -
                         pixel.template cast<S>());
};

/// Gravity in a reading, seen in the world; its z axis is vertical [m/s^2].
inline constexpr auto gravity_in_reading = [](const auto& left2world, const auto& left2imu,
                                              const auto& acc_bias, const auto& gravity, const vec3& acc) {
  using S = ScalarOf<decltype(left2world)>;
  const mtk::vect<3, S> acc_in_imu(acc.template cast<S>() - acc_bias);
  mtk::vect<3, S> difference = left2world.orient * (left2imu.inverse() * acc_in_imu);
  difference[2] -= gravity;
  return difference;
};

}  // namespace slom::app::calib
