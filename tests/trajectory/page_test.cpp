// The code of docs/trajectory.md, unchanged.
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include <mtk/testing/random.hpp>
#include <slom/slom.hpp>
#include <slom/trajectory.hpp>

namespace {

using Pose = mtk::trafo<mtk::SO3<>>;
using Vec3 = mtk::vect<3>;

/// A pose that a camera sees at a time of its clock.
struct Sighting {
  double time;
  Pose pose;
};
/// A reading of a gyroscope at a time of another clock.
struct Reading {
  double time;
  Vec3 rate;
};

/// The pose at a time.
struct PoseAtTime {
  auto operator()(const auto& pose, double t) const { return pose.poseAt(t); }
};

/// What a gyroscope reads. Its clock shows t when the clock of the trajectory shows t + offset.
struct GyroRate {
  auto operator()(const auto& pose, const auto& offset, const auto& bias, double t) const {
    return pose.angularVelocityAt(t + offset) + bias;
  }
};

constexpr double kOffset = 0.31;

Pose truth(double t) {
  return Pose(Vec3(2 * std::cos(t), std::sin(t), 0),
              mtk::SO3<>::exp(Vec3(0, 0, t)) * mtk::SO3<>::exp(Vec3(0.8 * std::sin(1.5 * t), 0, 0)));
}
Vec3 rate(double t) {
  const mtk::SO3<> tilt = mtk::SO3<>::exp(Vec3(0.8 * std::sin(1.5 * t), 0, 0));
  return tilt.inverse() * Vec3(0, 0, 1) + Vec3(1.2 * std::cos(1.5 * t), 0, 0);
}

TEST(TrajectoryPage, FindsTheOffsetOfAGyroscope) {
  mtk::testing::Random random(11);
  const auto noise = [&](double sigma) -> Vec3 {
    return Vec3(sigma * random.normal(), sigma * random.normal(), sigma * random.normal());
  };
  std::vector<Sighting> sightings;
  std::vector<Reading> readings;
  for (int i = 0; i <= 250; ++i) {
    const Pose pose = truth(0.04 * i);
    sightings.push_back(
        {0.04 * i, Pose(Vec3(pose.pos + noise(0.005)), pose.orient * mtk::SO3<>::exp(noise(0.005)))});
  }
  for (int i = 0; i < 1000; ++i)
    readings.push_back({0.01 * i, Vec3(rate(0.01 * i + kOffset) + Vec3(0.1, 0, -0.1) + noise(0.01))});

  const auto poseNear = [&](double t) {
    const double index = std::round(t / 0.04);
    return sightings[std::size_t(std::clamp(index, 0.0, 250.0))].pose;
  };

  slom::Estimator est;
  slom::trajectory::PoseSpline<5> pose(slom::trajectory::Knots(0, 0.2), "pose");
  pose.extend(est, 0, 10, poseNear);
  pose.tieEnds(est);
  for (const Sighting& sighting : sightings) {
    slom::trajectory::insertMeasurement(est, PoseAtTime(), pose.around(sighting.time), sighting.time,
                                        slom::measured(sighting.pose), slom::StandardDeviation(0.005));
  }

  const auto offset = est.insertRV(0.0, "offset");
  const auto bias = est.insertRV(mtk::vect<3>(), "bias");
  for (const Reading& reading : readings) {
    slom::trajectory::insertMeasurement(est, GyroRate(), pose.around(reading.time, offset), offset, bias,
                                        reading.time, slom::measured(reading.rate),
                                        slom::StandardDeviation(0.01));
  }

  const slom::Summary summary = slom::trajectory::optimize(est, {pose});
  const Vec3 velocity = pose.segmentAt(2.5).velocityAt(2.5);

  EXPECT_TRUE(summary.converged) << summary.message;
  const double sigma = est.standardDeviation(offset)[0];
  EXPECT_LT(std::abs(*offset - kOffset), 4 * sigma);
  EXPECT_LT(sigma, 1e-3);
  EXPECT_LT((velocity - Vec3(-2 * std::sin(2.5), std::cos(2.5), 0)).norm(), 0.1);
}

TEST(TrajectoryPage, FitsAGaussianProcess) {
  using namespace slom::trajectory;
  mtk::testing::Random random(12);
  const auto noise = [&](double sigma) -> Vec3 {
    return Vec3(sigma * random.normal(), sigma * random.normal(), sigma * random.normal());
  };
  std::vector<Sighting> sightings;
  for (int i = 0; i < 250; ++i) {
    const Pose pose = truth(0.04 * i);
    sightings.push_back(
        {0.04 * i, Pose(Vec3(pose.pos + noise(0.005)), pose.orient * mtk::SO3<>::exp(noise(0.005)))});
  }
  const auto poseNear = [&](double t) {
    return sightings[std::size_t(std::clamp(std::round(t / 0.04), 0.0, 249.0))].pose;
  };
  slom::Estimator est;

  PoseProcess<WhiteNoise::on_jerk> pose(Knots(0, 0.1), poseDensity(100, 100), "pose");
  pose.extend(est, 0, 10, poseNear);
  for (const Sighting& sighting : sightings) {
    insertMeasurement(est, PoseAtTime(), pose.around(sighting.time), sighting.time,
                      slom::measured(sighting.pose), slom::StandardDeviation(0.005));
  }

  const slom::Summary summary = optimize(est, {pose});
  EXPECT_TRUE(summary.converged) << summary.message;
  EXPECT_LT(summary.chi2PerDof(), 1.2);
  const auto at = pose.segmentAt(2.53);
  EXPECT_LT((at.positionAt(2.53) - truth(2.53).pos).norm(), 0.01);
  EXPECT_LT((at.angularVelocityAt(2.53) - rate(2.53)).norm(), 0.3);
}

}  // namespace
