#include "data.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <mtk/testing/random.hpp>

namespace slom::bench {

Motion::Motion(std::uint64_t seed) {
  mtk::testing::Random random(seed);
  for (int axis = 0; axis < 6; ++axis) {
    for (int k = 0; k < 3; ++k) {
      const double rate =
          2 * std::numbers::pi * random.uniform(0.2 + 0.5 * k, 0.7 + 0.5 * k);  // up to 1.7 Hz
      const double size = axis < 3 ? 0.5 : 0.8;                                 // m/s, rad/s
      sines_[axis][k] = {size / rate, rate, random.uniform(0, 2 * std::numbers::pi)};
    }
  }
}

Vec3 Motion::sum(int first, int derivative, double t) const {
  Vec3 result;
  for (int axis = 0; axis < 3; ++axis) {
    for (const Sine& s : sines_[first + axis]) {
      result[axis] += s.amplitude * std::pow(s.rate, derivative) *
                      std::sin(s.rate * t + s.phase + derivative * std::numbers::pi / 2);
    }
  }
  return result;
}

Rotation Motion::orientation(double t) const {
  const Vec3 a = sum(3, 0, t);
  return Rotation::exp(Vec3(a[0], 0, 0)) * Rotation::exp(Vec3(0, a[1], 0)) * Rotation::exp(Vec3(0, 0, a[2]));
}

Vec3 Motion::angularVelocity(double t) const {
  const Vec3 a = sum(3, 0, t), rate = sum(3, 1, t);
  const Rotation y = Rotation::exp(Vec3(0, a[1], 0)), z = Rotation::exp(Vec3(0, 0, a[2]));
  return z.inverse() * Vec3(y.inverse() * Vec3(rate[0], 0, 0) + Vec3(0, rate[1], 0)) + Vec3(0, 0, rate[2]);
}

Recording simulate(const Truth& truth, double duration, std::uint64_t seed) {
  mtk::testing::Random random(seed, 1);
  Recording all;
  all.noise = {2e-4, 2e-3, 0, 0};
  all.position_sigma = 0.002, all.angle_sigma = 0.002;
  constexpr double image_rate = 20, imu_rate = 200;
  for (int i = 0; i <= int(duration * image_rate); ++i) {
    const double t = i / image_rate;
    const Pose at = Pose(truth.motion.position(t), truth.motion.orientation(t)) * truth.body_T_camera;
    all.images.push_back({t, withNoise(at, random, all.position_sigma, all.angle_sigma)});
  }
  const Vec3 gyro_bias(0.01, -0.02, 0.005), force_bias(0.05, 0.1, -0.08);
  const double gyro_sigma = all.noise.gyro * std::sqrt(imu_rate),
               force_sigma = all.noise.force * std::sqrt(imu_rate);
  for (int i = -40; i <= int((duration + 0.2) * imu_rate); ++i) {  // 0.2 s more at both ends
    const double stamp = (i + 0.3) / imu_rate, t = stamp - truth.offset;
    const Vec3 force =
        truth.motion.orientation(t).inverse() * Vec3(truth.motion.acceleration(t) + Vec3(0, 0, kGravity));
    all.readings.push_back(
        {stamp, Vec3(truth.motion.angularVelocity(t) + gyro_bias + randomVector(random, gyro_sigma)),
         Vec3(force + force_bias + randomVector(random, force_sigma))});
  }
  all.body_T_camera = withNoise(truth.body_T_camera, random, 0.02, 0.03);
  return all;
}

const Pose& nearest(const std::vector<Sighting>& images, double t) {
  const auto after = std::lower_bound(images.begin(), images.end(), t,
                                      [](const Sighting& image, double time) { return image.time < time; });
  if (after == images.begin()) return after->pose;
  const auto before = after - 1;
  return after == images.end() || t - before->time < after->time - t ? before->pose : after->pose;
}

mtk::S2<> roughlyUp(const Recording& recording) {
  Vec3 sum;
  for (const ImuSample& reading : recording.readings) {
    const Pose& camera = nearest(recording.images, reading.time);
    sum += camera.orient * Vec3(recording.body_T_camera.orient.inverse() * reading.force);
  }
  return mtk::S2<>(Vec3(sum / sum.norm()));
}

}  // namespace slom::bench
