// The readings of an IMU between two images, as a measurement of the rig's states at both.
#pragma once

#include <type_traits>

#include <slom/slom.hpp>

#include "slom/calibration/types.hpp"
#include "slom/measurements/preintegration.hpp"

namespace slom::calibration {

/// What the readings measure: biases, and the clock of the IMU minus that of the cameras.
///   variables  left2world_i, left2world_j  poses of the reference camera at two images
///              velocity_i, velocity_j      of the IMU, in the world [m/s]
///              gyro_bias, force_bias       between both images [rad/s], [m/s^2]
///              left2imu                    points of the reference camera in the frame of the IMU
///              offset                      t_imu - t_camera [s]
///              up                          direction against gravity, in the world
///   residual   ImuMotion::residual: rotation [rad], velocity [m/s], position [m]
/// The readings are integrated anew for each value of the offset and the biases.
class ImuBetweenImages {
 public:
  /// Takes the times of two images, in the clock of the cameras [s]. What the samples refer to must outlive this object.
  ImuBetweenImages(const ImuSamples& samples, double from, double to, double gravity)
      : samples_(samples), from_(from), to_(to), gravity_(gravity) {}

  auto operator()(const auto& left2world_i, const auto& velocity_i, const auto& gyro_bias,
                  const auto& force_bias, const auto& left2world_j, const auto& velocity_j,
                  const auto& left2imu, const auto& offset, const auto& up) const {
    const auto imu2left = left2imu.inverse();
    const auto free_fall = up.vector() * (-gravity_);
    return motion(offset, gyro_bias, force_bias)
        .residual(left2world_i * imu2left, velocity_i, left2world_j * imu2left, velocity_j, free_fall,
                  to_ - from_);
  }

  /// Returns the motion between both images. Derivatives by offset and biases are computed first by themselves, because
  /// the integration is long and they are few.
  template <class D>
  ImuMotion<D> motion(const mtk::Scalar<D>& offset, const mtk::vect<3, D>& gyro_bias,
                      const mtk::vect<3, D>& force_bias) const {
    const D shift(offset);
    if constexpr (std::is_same_v<D, double>) {
      return samples_.motion(from_ + shift, to_ + shift, withoutBias(gyro_bias, force_bias));
    } else {
      using Local = mtk::SparseDual<double, mtk::detail::lowColumns(7)>;
      const auto seed = [](const D& x, int column) {
        Local local(x.value());
        local.partials().set(column, 1);
        return local;
      };
      const Local local_shift = seed(shift, 0);
      mtk::vect<3, Local> gyro, force;
      for (int i = 0; i < 3; ++i) gyro[i] = seed(gyro_bias[i], 1 + i), force[i] = seed(force_bias[i], 4 + i);
      const ImuMotion<Local> moved =
          samples_.motion(from_ + local_shift, to_ + local_shift, withoutBias(gyro, force));
      D change[7] = {shift - shift.value()};
      for (int i = 0; i < 3; ++i) {
        change[1 + i] = gyro_bias[i] - gyro_bias[i].value();
        change[4 + i] = force_bias[i] - force_bias[i].value();
      }
      const auto joined = [&](const mtk::vect<3, Local>& y) {
        mtk::vect<3, D> sum;
        for (int i = 0; i < 3; ++i) {
          sum[i] = D(y[i].value());
          for (int c = 0; c < 7; ++c) sum[i] += change[c] * y[i].partials().get(c);
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
  ImuSamples samples_;
  double from_, to_, gravity_;
};

}  // namespace slom::calibration
