// The errors of an IMU's axes: what corrected() makes of readings is the motion that gave them.
#include "slom/measurements/imu_model.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <mtk/testing/random.hpp>

#include "support/fresh_seed.hpp"

namespace slom::testing {
namespace {

using Vec3 = mtk::vect<3>;

TEST(ImuModel, CorrectedInvertsTheReadings) {
  const unsigned seed = freshSeed();
  mtk::testing::Random random(seed);
  const auto vector = [&](double most) {
    return Vec3(random.uniform(-most, most), random.uniform(-most, most), random.uniform(-most, most));
  };
  for (int trial = 0; trial < 100; ++trial) {
    ImuModel<> model;
    model.gyro_bias = vector(0.1), model.force_bias = vector(1);
    for (double& x : model.force_axes) x = random.uniform(-0.2, 0.2);
    for (double& x : model.gyro_axes) x = random.uniform(-0.2, 0.2);
    for (double& x : model.gyro_by_force) x = random.uniform(-0.01, 0.01);
    for (double& x : model.force_places) x = random.uniform(-0.1, 0.1);
    const Eigen::Vector3d w = vector(3), slope = vector(20), f = vector(15);
    Eigen::Vector3d felt = f;
    for (int k = 1; k < 3; ++k) {
      const Eigen::Vector3d r = model.force_places.segment<3>(3 * k - 3);
      felt[k] += (slope.cross(r) + w.cross(w.cross(r)))[k];
    }
    const auto& a = model.force_axes;
    const auto& g = model.gyro_axes;
    const auto& b = model.gyro_by_force;
    Eigen::Matrix3d M, G, A;
    M << 1 + a[0], 0, 0, a[1], 1 + a[2], 0, a[3], a[4], 1 + a[5];
    G << 1 + g[0], g[1], g[2], g[3], 1 + g[4], g[5], g[6], g[7], 1 + g[8];
    A << b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7], b[8];
    const Vec3 force(M * felt + model.force_bias), gyro(G * w + A * felt + model.gyro_bias),
        gyro_slope(G * slope);
    const auto [rate, push] = corrected(model)(gyro, force, gyro_slope);
    EXPECT_LT((rate - w).norm(), 1e-12) << seed;
    EXPECT_LT((push - f).norm(), 1e-12) << seed;
  }
}

/// An ideal model leaves the motion as it is, and the change of the angular velocity arrives.
TEST(ImuModel, AnIdealOneChangesNothing) {
  mtk::testing::Random random(3);
  std::vector<ImuSample> samples;
  for (int i = 0; i < 50; ++i)
    samples.push_back({0.01 * i, Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)),
                       Vec3(random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-9, 9))});
  const ImuSamples all(samples);
  const Vec3 none(0., 0., 0.);
  const auto plain = all.motion(0.033, 0.441, withoutBias(none, none));
  const auto ideal = all.motion(0.033, 0.441, corrected(ImuModel<>()));
  EXPECT_LT((plain.position - ideal.position).norm(), 1e-14);
  EXPECT_LT((plain.velocity - ideal.velocity).norm(), 1e-14);
  EXPECT_LT(mtk::SO3<>::log(plain.rotation.inverse() * ideal.rotation).norm(), 1e-14);
  all.pieces(0.112, 0.118, [&](double, const Vec3&, const Vec3&, const Vec3& slope) {
    EXPECT_LT((slope - (samples[12].gyro - samples[11].gyro) / 0.01).norm(), 1e-9);
  });
}

}  // namespace
}  // namespace slom::testing
