// Measurements of inertial navigation, on a simulated vehicle: derivatives, and NIS and NEES against chi-square.
#include <gtest/gtest.h>

#include <slom/filter.hpp>
#include <slom/filter/consistency.hpp>

#include "differences.hpp"
#include "random_matrices.hpp"
#include "support/fresh_seed.hpp"

namespace slom::testing {

using Vec3 = mtk::vect<3>;
using Orientation = mtk::SO3<>;
using Navigation = filter::StrapdownState<>;

template <class H, class... A>
void expectExactDerivative(const Navigation& x, const H& h, const A&... data) {
  const detail::MeasurementFunction<H, Navigation, std::nullptr_t, A...> function(h, nullptr, data...);
  using Function = std::remove_const_t<decltype(function)>;
  typename Function::Jacobian exact;
  function.differentiate(x, exact);
  const auto numeric = byDifferences<Function::rows>(x, function);
  EXPECT_LT((exact - numeric).norm(), 1e-9 * (1 + exact.norm())) << exact << "\n\n" << numeric;
}

Navigation anyState(RandomMatrices& random) {
  Navigation x;
  x.pose = mtk::trafo<mtk::SO3<>>(Orientation::exp(random.vector<3>()), random.vector<3>(10));
  x.velocity = random.vector<3>(5);
  x.gyro_bias = random.vector<3>(0.1);
  x.force_bias = random.vector<3>(0.2);
  return x;
}

TEST(StrapdownModels, MeasurementsHaveExactDerivatives) {
  RandomMatrices random(freshSeed());
  for (int i = 0; i < 20; ++i) {
    const Navigation x = anyState(random);
    const Vec3 z = random.vector<3>(), lever = random.vector<3>(), gyro = random.vector<3>();
    expectExactDerivative(x, filter::GnssPosition(), z, lever);
    expectExactDerivative(x, filter::GnssVelocity(), z, lever, gyro);
    expectExactDerivative(x, filter::NoSideslip());
    expectExactDerivative(x, filter::ZeroVelocity());
  }
}

TEST(StrapdownModels, VelocityOfAnAntennaIsThatOfItsPosition) {
  RandomMatrices random(freshSeed());
  for (int i = 0; i < 20; ++i) {
    const Navigation x = anyState(random);
    const Vec3 zero(0, 0, 0), lever = random.vector<3>(), gyro = random.vector<3>(),
                              force = random.vector<3>(10);
    const auto place = [&](double dt) {
      return filter::GnssPosition()(filter::Strapdown()(x, gyro, force, dt), zero, lever);
    };
    const double h = 1e-4;
    const Vec3 by_differences((place(h) - place(-h)) / (2 * h));
    EXPECT_LT((filter::GnssVelocity()(x, zero, lever, gyro) - by_differences).norm(), 1e-6);
  }
}

/// What a run adds to its reports.
struct RunReports {
  InnovationReport<3> velocity;
  InnovationReport<2> sideslip;
  NeesReport nees;
};

/// Drives for 20 s on a winding road with a noisy IMU. The antenna's velocity and the absence of sideslip are measured, and
/// the position every 5 s.
template <class Filter>
void drive(RandomMatrices& random, RunReports& reports) {
  const double dt = 0.05;
  const ImuNoise imu{2e-3, 2e-2, 1e-4, 1e-3};
  const Vec3 lever(1, -0.5, 1.5), up(0, 0, 9.81);
  const double velocity_sigma = 0.1, slip_sigma = 0.05, position_sigma = 0.5;

  Navigation truth;
  truth.pose.orient = Orientation::exp(Vec3(0, 0, 3 * random.normal()));
  truth.velocity = truth.pose.orient * Vec3(10, 0, 0);
  truth.gyro_bias = random.vector<3>(0.01);
  truth.force_bias = random.vector<3>(0.05);
  mtk::vect<15> sigma;
  sigma << 1, 1, 1, 0.03, 0.03, 0.03, 0.5, 0.5, 0.5, 0.01, 0.01, 0.01, 0.05, 0.05, 0.05;
  mtk::vect<15> e;
  for (int i = 0; i < 15; ++i) e[i] = sigma[i] * random.normal();
  Navigation start = truth;  // the truth is start [+] e
  start.pose.pos -= Vec3(e.segment<3>(0));
  start.pose.orient = truth.pose.orient * Orientation::exp(Vec3(e.segment<3>(3))).inverse();
  start.velocity -= Vec3(e.segment<3>(6));
  start.gyro_bias -= Vec3(e.segment<3>(9));
  start.force_bias -= Vec3(e.segment<3>(12));
  Filter filter(start, StandardDeviation(sigma));

  for (int k = 1; k <= 400; ++k) {
    const double t = k * dt, speed = 10 + 3 * std::sin(0.5 * t);
    const Vec3 rate(0.1 * std::sin(t), 0.05 * std::cos(0.8 * t), 0.4 * std::sin(0.3 * t));
    const Orientation half = Orientation::exp(Vec3(rate * (dt / 2))), middle = truth.pose.orient * half;
    // The force that leads to this speed along the body, with a slip.
    const Vec3 slip(0, slip_sigma * random.normal(), slip_sigma * random.normal());
    const Vec3 next_velocity = middle * half * Vec3(Vec3(speed, 0, 0) + (k % 10 == 0 ? slip : Vec3(0, 0, 0)));
    const Vec3 force = middle.inverse() * Vec3((next_velocity - truth.velocity) / dt + up);
    const Vec3 gyro_read(rate + truth.gyro_bias + random.vector<3>(imu.gyro / std::sqrt(dt)));
    const Vec3 force_read(force + truth.force_bias + random.vector<3>(imu.force / std::sqrt(dt)));
    truth = filter::Strapdown()(truth, Vec3(rate + truth.gyro_bias), Vec3(force + truth.force_bias), dt);
    truth.gyro_bias += random.vector<3>(imu.gyro_walk * std::sqrt(dt));
    truth.force_bias += random.vector<3>(imu.force_walk * std::sqrt(dt));
    ASSERT_TRUE(filter.predict(slom::filter::Strapdown(), slom::filter::strapdownNoise(imu, dt), gyro_read,
                               force_read, dt));
    if (k % 10 != 0) continue;
    reports.sideslip.add(filter.update(filter::NoSideslip(), StandardDeviation(slip_sigma)));
    const Vec3 zero(0, 0, 0);
    const Vec3 seen(filter::GnssVelocity()(truth, zero, lever, Vec3(rate + truth.gyro_bias)) +
                    random.vector<3>(velocity_sigma));
    reports.velocity.add(
        filter.update(filter::GnssVelocity(), seen, lever, gyro_read, StandardDeviation(velocity_sigma)));
    if (k % 100 != 0) continue;
    const Vec3 place(filter::GnssPosition()(truth, zero, lever) + random.vector<3>(position_sigma));
    ASSERT_TRUE(filter.update(filter::GnssPosition(), place, lever, StandardDeviation(position_sigma)));
  }
  reports.nees.add(filter.nees(truth), 15);
}

template <class Filter>
void expectConsistentDrives(unsigned seed) {
  RandomMatrices random(seed);
  RunReports reports;
  for (int run = 0; run < 200; ++run) drive<Filter>(random, reports);
  EXPECT_GT(reports.nees.mean(), reports.nees.lower()) << reports.nees.sentence();
  EXPECT_LT(reports.nees.mean(), reports.nees.upper()) << reports.nees.sentence();
  EXPECT_NEAR(reports.velocity.mean(), 1, 0.03) << reports.velocity.sentence();
  EXPECT_NEAR(reports.sideslip.mean(), 1, 0.03) << reports.sideslip.sentence();
  EXPECT_NEAR(reports.velocity.correlation(), 0, 0.03) << reports.velocity.sentence();
  EXPECT_NEAR(reports.sideslip.correlation(), 0, 0.03) << reports.sideslip.sentence();
}

TEST(StrapdownModels, VelocityAndNoSideslipAreConsistentIn200Drives) {
  expectConsistentDrives<ErrorStateFilter<Navigation>>(1);
  expectConsistentDrives<ErrorStateFilter<Navigation, SquareRootCovariance>>(2);
}

}  // namespace slom::testing
