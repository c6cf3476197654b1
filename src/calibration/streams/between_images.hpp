// The readings of an IMU between two images, as a measurement of the rig's states at both.
#pragma once

#include <array>
#include <type_traits>

#include <slom/slom.hpp>

#include "slom/calibration/types.hpp"
#include "slom/measurements/imu_model.hpp"
#include "slom/measurements/preintegration.hpp"

namespace slom::calibration {

/// The motion between two images as the readings state it, minus the motion of the poses.
///   variables  left2world_i, left2world_j  poses of the reference camera at two images
///              velocity_i, velocity_j      of the IMU, in the world [m/s]
///              gyro_bias, force_bias       between both images [rad/s], [m/s^2]
///              left2imu                    points of the reference camera in the frame of the IMU
///              offset                      t_imu - t_camera [s]
///              up                          direction against gravity, in the world
///              board_scale                 true length on the board / length of the poses left2world
///              axes                        of ImuModel, in its order, from force_axes to force_places; none: of an ideal IMU
///   residual   ImuMotion::residual: rotation [rad], velocity [m/s], position [m]
/// The readings are integrated anew for each value of offset, biases and axes.
class ImuBetweenImages {
 public:
  /// Takes the times of two images, in the clock of the cameras [s]. What the samples refer to must outlive this object.
  ImuBetweenImages(const ImuSamples& samples, double from, double to, double gravity)
      : samples_(samples), from_(from), to_(to), gravity_(gravity) {}

  auto operator()(const auto& left2world_i, const auto& velocity_i, const auto& gyro_bias,
                  const auto& force_bias, const auto& left2world_j, const auto& velocity_j,
                  const auto& left2imu, const auto& offset, const auto& up, const auto& board_scale,
                  const auto&... axes) const {
    const auto imu2left = left2imu.inverse();
    const auto free_fall = up.vector() * (-gravity_);
    return motion(offset, gyro_bias, force_bias, axes...)
        .residual(onBoard(board_scale, left2world_i, imu2left), velocity_i,
                  onBoard(board_scale, left2world_j, imu2left), velocity_j, free_fall, to_ - from_);
  }

  /// Returns the motion between both images. Derivatives by offset, biases and axes are computed first by themselves,
  /// because the integration is long and they are few.
  template <class D, int... N>
  ImuMotion<D> motion(const mtk::Scalar<D>& offset, const mtk::vect<3, D>& gyro_bias,
                      const mtk::vect<3, D>& force_bias, const mtk::vect<N, D>&... axes) const {
    constexpr int n = 7 + (N + ... + 0);
    std::array<D, n> values;
    auto next = values.begin();
    *next++ = D(offset);
    const auto append = [&](const auto& vector) {
      for (int i = 0; i < int(vector.size()); ++i) *next++ = vector[i];
    };
    append(gyro_bias), append(force_bias), (append(axes), ...);
    if constexpr (std::is_same_v<D, double>) {
      return integrated(values);
    } else {
      using Local = mtk::SparseDual<double, mtk::detail::lowColumns(n)>;
      std::array<Local, n> locals;
      for (int c = 0; c < n; ++c) {
        locals[std::size_t(c)] = Local(values[std::size_t(c)].value());
        locals[std::size_t(c)].partials().set(c, 1);
        values[std::size_t(c)] -= values[std::size_t(c)].value();  // the derivatives alone
      }
      const ImuMotion<Local> moved = integrated(locals);
      const auto joined = [&](const mtk::vect<3, Local>& y) {
        mtk::vect<3, D> sum;
        for (int i = 0; i < 3; ++i) {
          sum[i] = D(y[i].value());
          for (int c = 0; c < n; ++c) sum[i] += values[std::size_t(c)] * y[i].partials().get(c);
        }
        return sum;
      };
      const SO3 at(moved.rotation.w().value(), moved.rotation.x().value(), moved.rotation.y().value(),
                   moved.rotation.z().value());
      ImuMotion<D> result;
      result.rotation =
          at * mtk::SO3<D>::exp(joined(mtk::SO3<Local>::log(mtk::SO3<Local>(at.inverse()) * moved.rotation)));
      result.velocity = joined(moved.velocity);
      result.position = joined(moved.position);
      return result;
    }
  }

 private:
  /// Returns the pose of the IMU in the world, in true lengths.
  template <class D>
  static auto onBoard(const mtk::Scalar<D>& scale, const auto& left2world, const auto& imu2left) {
    auto pose = left2world * imu2left;
    for (int i = 0; i < 3; ++i) pose.pos[i] += (D(scale) - 1) * left2world.pos[i];
    return pose;
  }

  /// Integrates with offset, biases and, if given, axes: 7 or 37 numbers.
  template <class S, std::size_t n>
  ImuMotion<S> integrated(const std::array<S, n>& values) const {
    std::size_t next = 1;
    const auto take = [&](auto& vector) {
      for (int i = 0; i < int(vector.size()); ++i) vector[i] = values[next++];
    };
    const S from = from_ + values[0], to = to_ + values[0];
    ImuModel<S> model;
    take(model.gyro_bias), take(model.force_bias);
    if constexpr (n == 7) {
      return samples_.motion(from, to, withoutBias(model.gyro_bias, model.force_bias));
    } else {
      take(model.force_axes), take(model.gyro_axes), take(model.gyro_by_force), take(model.force_places);
      return samples_.motion(from, to, corrected(model));
    }
  }

  ImuSamples samples_;
  double from_, to_, gravity_;
};

}  // namespace slom::calibration
