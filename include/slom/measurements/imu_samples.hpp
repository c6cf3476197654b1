/// Readings of an IMU, and the motion between two times that follows from them.
///
///     slom::ImuSamples samples(readings);   // refers to the readings
///     const auto moved = samples.motion(from, to, slom::withoutBias(gyro_bias, force_bias));
///
/// Times and biases may be variables: over dual numbers, the motion has the exact derivatives by them.
///   source   Forster, Carlone, Dellaert, Scaramuzza, "On-manifold preintegration for real-time visual-inertial
///            odometry", 2017, equations 26 and 33
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>

#include "mtk/dual.hpp"
#include "mtk/types/trafo.hpp"
#include "slom/model/imu_noise.hpp"

namespace slom {

/// One reading of a gyroscope and an accelerometer, in the axes of the IMU.
struct ImuSample {
  double time = 0;     ///< [s]
  mtk::vect<3> gyro;   ///< angular velocity [rad/s]
  mtk::vect<3> force;  ///< specific force: acceleration minus gravity [m/s^2]
};

namespace detail {

/// Returns the number without derivatives.
inline double withoutDerivatives(double x) { return x; }
template <std::uint64_t C>
double withoutDerivatives(const mtk::SparseDual<double, C>& x) {
  return x.value();
}

}  // namespace detail

/// Returns a function that subtracts biases from readings, for ImuSamples::motion.
template <class S>
auto withoutBias(const mtk::vect<3, S>& gyro_bias, const mtk::vect<3, S>& force_bias) {
  return [gyro_bias, force_bias](const mtk::vect<3, S>& gyro, const mtk::vect<3, S>& force) {
    return std::pair(mtk::vect<3, S>(gyro - gyro_bias), mtk::vect<3, S>(force - force_bias));
  };
}

/// Motion of an IMU over some time, from its readings alone: without gravity, and from a start at rest.
template <class S = double>
struct ImuMotion {
  mtk::SO3<S> rotation;                        ///< start_R_end
  mtk::vect<3, S> velocity{S(0), S(0), S(0)};  ///< in the frame of the start [m/s]
  mtk::vect<3, S> position{S(0), S(0), S(0)};  ///< likewise [m]

  /// Adds `duration` with constant readings. The specific force turns with the IMU; its mean direction is the
  /// direction at half the duration, to third order in the duration.
  void add(const mtk::vect<3, S>& rate, const mtk::vect<3, S>& force, const S& duration) {
    const mtk::vect<3, S> half(rate * (duration / S(2)));
    const mtk::SO3<S> half_turn = mtk::SO3<S>::exp(half);
    const mtk::vect<3, S> gained((rotation * (half_turn * force)) * duration);
    position += velocity * duration + gained * (duration / S(2));
    velocity += gained;
    rotation = rotation * half_turn * half_turn;
  }

  /// Returns (rotation, velocity, position) of the motion between two states, minus this motion.
  auto residual(const auto& pose_i, const auto& velocity_i, const auto& pose_j, const auto& velocity_j,
                const auto& gravity, const auto& duration) const {
    const auto back = pose_i.orient.inverse();
    const auto turn = rotation.inverse() * (back * pose_j.orient);
    const auto r = decltype(rotation.inverse() * (back * pose_j.orient))::log(turn);
    const auto v = back * (velocity_j - velocity_i - gravity * duration) - velocity;
    const auto p =
        back * (pose_j.pos - pose_i.pos - velocity_i * duration - gravity * (duration * duration / 2)) -
        position;
    return mtk::vector(r[0], r[1], r[2], v[0], v[1], v[2], p[0], p[1], p[2]);
  }
};

/// Samples in the order of time, read at any time: linear between two samples, constant beyond the first and last.
class ImuSamples {
 public:
  ImuSamples() = default;
  /// The samples must be finite, and their times must rise. They must outlive this object.
  explicit ImuSamples(std::span<const ImuSample> samples) : samples_(samples) {}

  double begin() const { return samples_.front().time; }  ///< of the first sample [s]
  double end() const { return samples_.back().time; }     ///< of the last sample [s]
  /// Returns the samples.
  std::span<const ImuSample> all() const { return samples_; }

  /// Calls `each(duration, gyro, force)` with the mean readings of each piece between two times: pieces end at samples.
  /// Times may carry derivatives. The readings change linearly between samples. If `each` takes a fourth argument, it gets
  /// the change of the angular velocity with time [rad/s^2].
  template <class S>
  void pieces(const S& from, const S& to, auto&& each) const {
    std::size_t next = after(detail::withoutDerivatives(from));
    S time = from;
    Reading<S> reading = readingAt<S>(time, next);
    for (bool is_last = false; !is_last; ++next) {
      is_last = next >= samples_.size() || samples_[next].time >= detail::withoutDerivatives(to);
      const S end = is_last ? to : S(samples_[next].time);
      const Reading<S> other = readingAt<S>(end, next);
      const mtk::vect<3, S> gyro((reading.gyro + other.gyro) / S(2)),
          force((reading.force + other.force) / S(2));
      if constexpr (std::is_invocable_v<decltype(each), S, mtk::vect<3, S>, mtk::vect<3, S>, mtk::vect<3, S>>)
        each(S(end - time), gyro, force, slopeAt<S>(next));
      else
        each(S(end - time), gyro, force);
      time = end;
      reading = other;
    }
  }

  /// Returns the motion between two times. `corrected(gyro, force)`, or `corrected(gyro, force, slope)` with the change of
  /// the angular velocity, returns the pair of angular velocity and specific force from readings, such as withoutBias().
  template <class S>
  ImuMotion<S> motion(const S& from, const S& to, const auto& corrected) const {
    using V = mtk::vect<3, S>;
    ImuMotion<S> motion;
    if constexpr (std::is_invocable_v<decltype(corrected), V, V, V>) {
      pieces(from, to, [&](const S& duration, const V& gyro, const V& force, const V& slope) {
        const auto [rate, push] = corrected(gyro, force, slope);
        motion.add(rate, push, duration);
      });
    } else {
      pieces(from, to, [&](const S& duration, const V& gyro, const V& force) {
        const auto [rate, push] = corrected(gyro, force);
        motion.add(rate, push, duration);
      });
    }
    return motion;
  }

 private:
  template <class S>
  struct Reading {
    mtk::vect<3, S> gyro, force;
  };

  /// Returns the index of the first sample after a time.
  std::size_t after(double time) const {
    return std::size_t(std::upper_bound(samples_.begin(), samples_.end(), time,
                                        [](double t, const ImuSample& s) { return t < s.time; }) -
                       samples_.begin());
  }
  /// Returns the change of the angular velocity between samples next - 1 and next [rad/s^2].
  template <class S>
  mtk::vect<3, S> slopeAt(std::size_t next) const {
    if (next == 0 || next >= samples_.size()) return mtk::vect<3, S>(mtk::vect<3>(0., 0., 0.));
    const ImuSample &a = samples_[next - 1], &b = samples_[next];
    return mtk::vect<3, S>(mtk::vect<3>((b.gyro - a.gyro) / (b.time - a.time)));
  }
  /// Returns the reading at a time between samples next - 1 and next.
  template <class S>
  Reading<S> readingAt(const S& time, std::size_t next) const {
    if (next == 0 || next >= samples_.size()) {
      const ImuSample& only = next == 0 ? samples_.front() : samples_.back();
      return {mtk::vect<3, S>(only.gyro), mtk::vect<3, S>(only.force)};
    }
    const ImuSample &a = samples_[next - 1], &b = samples_[next];
    const S along = (time - S(a.time)) / S(b.time - a.time);
    const auto between = [&](const mtk::vect<3>& x, const mtk::vect<3>& y) {
      const mtk::vect<3> change(y - x);
      return mtk::vect<3, S>(S(x[0]) + along * S(change[0]), S(x[1]) + along * S(change[1]),
                             S(x[2]) + along * S(change[2]));
    };
    return {between(a.gyro, b.gyro), between(a.force, b.force)};
  }

  std::span<const ImuSample> samples_;
};

}  // namespace slom
