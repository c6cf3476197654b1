/// Errors of an IMU's axes: scale, misalignment, sensitivity of the gyroscope to forces, places of the accelerometers.
///
///     slom::ImuModel<> model;                       // an ideal IMU
///     model.force_axes[0] = 0.01;                   // x reads 1 % too much
///     const auto moved = samples.motion(from, to, slom::corrected(model));
///
/// What the IMU reads, if it turns by w [rad/s] and feels the specific force f [m/s^2], in its own axes:
///   force  M (f + s) + force_bias       M = [1+a0 0 0; a1 1+a2 0; a3 a4 1+a5], a = force_axes
///   gyro   G w + A f + gyro_bias        G = I + gyro_axes, A = gyro_by_force, both row by row
/// The axes of the IMU are those of the accelerometer: x is that of its x axis, and y lies in the plane of its x and y axes.
/// s is what the places r_y, r_z of the accelerometers for y and z, relative to that for x, add: component k is that of
/// (dw/dt x r_k + w x (w x r_k)).
///   source  Rehder, Nikolic, Schneider, Hinzmann, Siegwart, "Extending kalibr: Calibrating the extrinsics of multiple
///           IMUs and of individual axes", 2016, equations 1 to 8
#pragma once

#include <utility>

#include "slom/measurements/imu_samples.hpp"

namespace slom {

/// The values. Zero: an ideal IMU.
template <class S = double>
struct ImuModel {
  mtk::vect<3, S> gyro_bias{S(0), S(0), S(0)};   ///< [rad/s]
  mtk::vect<3, S> force_bias{S(0), S(0), S(0)};  ///< [m/s^2]
  mtk::vect<6, S> force_axes = zero<6>();        ///< scales and misalignments
  mtk::vect<9, S> gyro_axes = zero<9>();         ///< likewise, and the rotation between both sensors
  mtk::vect<9, S> gyro_by_force = zero<9>();     ///< [rad/s / (m/s^2)]
  mtk::vect<6, S> force_places = zero<6>();      ///< r_y, r_z [m]

 private:
  template <int N>
  static mtk::vect<N, S> zero() {
    mtk::vect<N, S> all;
    for (int i = 0; i < N; ++i) all[i] = S(0);
    return all;
  }
};

namespace detail {

/// Returns component k of a x b.
template <class S>
S cross(const mtk::vect<3, S>& a, const mtk::vect<3, S>& b, int k) {
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  return a[i] * b[j] - a[j] * b[i];
}
template <class S>
mtk::vect<3, S> cross(const mtk::vect<3, S>& a, const mtk::vect<3, S>& b) {
  return {cross(a, b, 0), cross(a, b, 1), cross(a, b, 2)};
}

}  // namespace detail

/// Returns the function that turns readings into angular velocity and specific force, for ImuSamples::motion.
template <class S>
auto corrected(const ImuModel<S>& model) {
  using V = mtk::vect<3, S>;
  const auto& g = model.gyro_axes;
  const S m[9] = {S(1) + g[0], g[1], g[2], g[3], S(1) + g[4], g[5], g[6], g[7], S(1) + g[8]};
  const S minor[9] = {m[4] * m[8] - m[5] * m[7], m[2] * m[7] - m[1] * m[8], m[1] * m[5] - m[2] * m[4],
                      m[5] * m[6] - m[3] * m[8], m[0] * m[8] - m[2] * m[6], m[2] * m[3] - m[0] * m[5],
                      m[3] * m[7] - m[4] * m[6], m[1] * m[6] - m[0] * m[7], m[0] * m[4] - m[1] * m[3]};
  const S determinant = m[0] * minor[0] + m[1] * minor[3] + m[2] * minor[6];
  struct Inverse {
    S entry[9];
    V operator*(const V& v) const {
      V product;
      for (int i = 0; i < 3; ++i)
        product[i] = entry[3 * i] * v[0] + entry[3 * i + 1] * v[1] + entry[3 * i + 2] * v[2];
      return product;
    }
  } inverse;
  for (int i = 0; i < 9; ++i) inverse.entry[i] = minor[i] / determinant;
  return [model, inverse](const V& gyro, const V& force, const V& gyro_slope) {
    const V f(force - model.force_bias);
    const auto& a = model.force_axes;
    V push;
    push[0] = f[0] / (S(1) + a[0]);
    push[1] = (f[1] - a[1] * push[0]) / (S(1) + a[2]);
    push[2] = (f[2] - a[3] * push[0] - a[4] * push[1]) / (S(1) + a[5]);
    const auto& by_force = model.gyro_by_force;
    const auto rateFor = [&](const V& felt) {
      V w(gyro - model.gyro_bias);
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) w[i] -= by_force[3 * i + j] * felt[j];
      }
      return inverse * w;
    };
    const V rate = rateFor(push), turn = inverse * gyro_slope;
    const auto& r = model.force_places;
    for (int k = 1; k < 3; ++k) {
      const V place(r[3 * k - 3], r[3 * k - 2], r[3 * k - 1]);
      push[k] -= detail::cross(turn, place, k) + detail::cross(rate, detail::cross(rate, place), k);
    }
    return std::pair(rate, push);
  };
}

}  // namespace slom
