/// PreintegratedImu: the readings of an IMU between two times as one measurement of the states at both.
///
///     slom::PreintegratedImu moved(samples, from, to, noise, gyro_bias, force_bias);
///     est.insertMeasurement(moved, pose_i, velocity_i, gyro_bias_i, force_bias_i, pose_j, velocity_j, gravity,
///                           slom::Covariance(moved.covariance()));
///
///   variables  pose_i, pose_j          world_T_imu at `from` and `to`, mtk::trafo<mtk::SO3<>>
///              velocity_i, velocity_j  of the IMU's origin, in the world, 3 [m/s]
///              gyro_bias, force_bias   subtracted from the readings, 3 [rad/s] and 3 [m/s^2]
///              gravity                 acceleration of free fall in the world: 3 [m/s^2], downwards
///   residual   rotation vector [rad], velocity [m/s], position [m] of the states' motion minus the readings', in the
///              IMU's frame at `from`
///   source     Forster, Carlone, Dellaert, Scaramuzza, "On-manifold preintegration for real-time visual-inertial
///              odometry", 2017: residual (45), correction by biases (44), covariance (62)
/// Each variable may be a constant. At rest, an accelerometer reads the reaction to gravity, upwards.
///
/// The readings are integrated once, with the biases given here. Other biases enter to first order; make the measurement
/// anew if they differ by more than about 0.01 rad/s or 0.1 m/s^2 over a second. `biasWalk` returns the noise between
/// the biases of both states.
#pragma once

#include <cmath>

#include <Eigen/Core>

#include "slom/measurements/imu_samples.hpp"

namespace slom {

/// Readings between two times, integrated once. The comment of this file shows how to insert them.
class PreintegratedImu {
 public:
  using Covariance9 = Eigen::Matrix<double, 9, 9>;

  /// Integrates the readings from one time to a later one. `noise` states densities; those of the walks are not used
  /// here.
  PreintegratedImu(const ImuSamples& samples, double from, double to, const ImuNoise& noise,
                   const mtk::vect<3>& gyro_bias = {0., 0., 0.},
                   const mtk::vect<3>& force_bias = {0., 0., 0.})
      : duration_(to - from), gyro_bias_(gyro_bias), force_bias_(force_bias) {
    integrate(samples, from, to);
    propagate(samples, from, to, noise);
  }

  double duration() const { return duration_; }  ///< [s]
  /// Returns the covariance of the residual.
  const Covariance9& covariance() const { return covariance_; }
  /// Returns the motion with other biases, to first order.
  template <class S = double>
  ImuMotion<S> motion(const mtk::vect<3, S>& gyro_bias, const mtk::vect<3, S>& force_bias) const {
    const mtk::vect<3, S> by_gyro(gyro_bias - gyro_bias_), by_force(force_bias - force_bias_);
    const auto changed = [&](int row) {
      mtk::vect<3, S> sum(S(0), S(0), S(0));
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j)
          sum[i] += by_gyro[j] * by_bias_(row + i, j) + by_force[j] * by_bias_(row + i, 3 + j);
      }
      return sum;
    };
    ImuMotion<S> other;
    other.rotation = motion_.rotation * mtk::SO3<S>::exp(changed(0));
    other.velocity = motion_.velocity + changed(3);
    other.position = motion_.position + changed(6);
    return other;
  }

  auto operator()(const auto& pose_i, const auto& velocity_i, const auto& gyro_bias, const auto& force_bias,
                  const auto& pose_j, const auto& velocity_j, const auto& gravity) const {
    using S = mtk::promote_t<typename std::decay_t<decltype(gyro_bias)>::Scalar,
                             typename std::decay_t<decltype(force_bias)>::Scalar>;
    return motion<S>(mtk::vect<3, S>(gyro_bias), mtk::vect<3, S>(force_bias))
        .residual(pose_i, velocity_i, pose_j, velocity_j, gravity, duration_);
  }

 private:
  /// Sets the motion and its derivatives by the biases.
  void integrate(const ImuSamples& samples, double from, double to) {
    using Dual = mtk::SparseDual<double, mtk::detail::lowColumns(6)>;
    mtk::vect<3, Dual> gyro(gyro_bias_), force(force_bias_);
    for (int i = 0; i < 3; ++i) {
      gyro[i].partials().set(i, 1);
      force[i].partials().set(3 + i, 1);
    }
    const ImuMotion<Dual> moved = samples.motion(Dual(from), Dual(to), withoutBias(gyro, force));
    for (int i = 0; i < 3; ++i) {
      motion_.velocity[i] = moved.velocity[i].value();
      motion_.position[i] = moved.position[i].value();
    }
    motion_.rotation = mtk::SO3<>(moved.rotation.w().value(), moved.rotation.x().value(),
                                  moved.rotation.y().value(), moved.rotation.z().value());
    const auto turn = mtk::SO3<Dual>::log(motion_.rotation.inverse() * moved.rotation);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 6; ++j) {
        by_bias_(i, j) = turn[i].partials().get(j);
        by_bias_(3 + i, j) = moved.velocity[i].partials().get(j);
        by_bias_(6 + i, j) = moved.position[i].partials().get(j);
      }
    }
  }

  /// Sets the covariance: that of the errors of rotation (on its right), velocity and position.
  void propagate(const ImuSamples& samples, double from, double to, const ImuNoise& noise) {
    covariance_.setZero();
    samples.pieces(
        from, to,
        [&, moved = ImuMotion<>()](double h, const mtk::vect<3>& gyro, const mtk::vect<3>& force) mutable {
          const mtk::vect<3> rate(gyro - gyro_bias_), push(force - force_bias_);
          const mtk::SO3<> half_turn = mtk::SO3<>::exp(mtk::vect<3>(rate * (h / 2)));
          const Eigen::Matrix3d R = (moved.rotation * half_turn).toRotationMatrix();
          Covariance9 A = Covariance9::Identity();
          A.topLeftCorner<3, 3>() = (half_turn * half_turn).inverse().toRotationMatrix();
          Eigen::Matrix3d cross;
          cross << 0, -push[2], push[1], push[2], 0, -push[0], -push[1], push[0], 0;
          const Eigen::Matrix3d by_turn = -R * cross * half_turn.inverse().toRotationMatrix() * h;
          A.block<3, 3>(3, 0) = by_turn;
          A.block<3, 3>(6, 0) = by_turn * (h / 2);
          A.block<3, 3>(6, 3).diagonal().setConstant(h);
          Eigen::Matrix<double, 9, 6> B = Eigen::Matrix<double, 9, 6>::Zero();
          B.topLeftCorner<3, 3>() = noise.gyro * std::sqrt(h) * Eigen::Matrix3d::Identity();
          B.block<3, 3>(3, 3) = noise.force * std::sqrt(h) * R;
          B.block<3, 3>(6, 3) = B.block<3, 3>(3, 3) * (h / 2);
          covariance_ = A * covariance_ * A.transpose() + B * B.transpose();
          // Within the piece, velocity noise gives position noise of its own: h^3 / 12 of the density.
          covariance_.block<3, 3>(6, 6).diagonal().array() += noise.force * noise.force * h * h * h / 12;
          moved.add(rate, push, h);
        });
  }

  double duration_;
  mtk::vect<3> gyro_bias_, force_bias_;
  ImuMotion<> motion_;
  Eigen::Matrix<double, 9, 6> by_bias_;  ///< by (gyro_bias, force_bias)
  Covariance9 covariance_;
};

}  // namespace slom
