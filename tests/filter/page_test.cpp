// The code of docs/filters.md, docs/filter_models.md and docs/filter_reports.md, unchanged.
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include <slom/filter.hpp>
#include <slom/filter/adaptive_noise.hpp>
#include <slom/filter/consistency.hpp>
#include <slom/filter/history.hpp>
#include <slom/filter/observability.hpp>

#include "support/documentation.hpp"
#include "support/paths.hpp"

namespace {

// clang-format off
template <class S>
struct RobotOf {
  mtk::trafo<mtk::SO3<S>> pose;  // world_T_body
  mtk::vect<3, S> velocity;      // in the world
};
using Robot = RobotOf<double>;
using Vec3 = mtk::vect<3>;

/// Turns with the rate that the gyroscope reads, and keeps the velocity.
struct Move {
  auto operator()(const auto& x, const Vec3& gyro, double dt) const {
    auto next = x;
    next.pose.pos = x.pose.pos + x.velocity * dt;
    next.pose.orient = x.pose.orient * mtk::SO3<>::exp(Vec3(gyro * dt));
    return next;
  }
};

TEST(FiltersPage, RunsAsShown) {
  slom::ErrorStateFilter filter(Robot{}, slom::StandardDeviation(0.1));
  mtk::vect<9> density;                                     // of pos, orient, velocity
  density << 0, 0, 0, 1e-6, 1e-6, 1e-6, 0.01, 0.01, 0.01;  // squared units per second
  const auto position = [](const auto& x, const Vec3& gps) { return x.pose.pos - gps; };
  for (int k = 0; k < 10; ++k) {
    const auto step = filter.predict(Move(), slom::SpectralDensity(density), Vec3(0, 0, 0.2), slom::Duration(0.1));
    if (!step) std::puts(step.message());
    const auto update = filter.update(position, Vec3(0.1 * k, 0, 0), slom::StandardDeviation(0.5), slom::Gate(0.999));
    if (!update) std::puts(update.message());
  }
  EXPECT_NEAR(filter.state().pose.orient.z(), std::sin(0.1), 1e-9);
  slom::InnovationReport<3> report;
  report.add(filter.update(position, Vec3(1, 0, 0), slom::StandardDeviation(0.5)));
  EXPECT_EQ(report.count(), 1);
}

TEST(FilterModelsPage, RunsAsShown) {
  slom::filter::AttitudeNoise<> usual;  // change what your data sheet says
  usual.gyro = 1e-4;                    // rad/s/sqrt(Hz)
  slom::filter::AttitudeFilter<> attitude{usual};
  const slom::FilterStatus status = attitude.step(Vec3(0, 0, 0.1), Vec3(0, 0, 9.81), Vec3(0, 20, -40), 0.01);
  if (status != slom::FilterStatus::done) std::puts(toString(status));
  const Vec3 forward = attitude.orientation() * Vec3(1, 0, 0);  // the body's x axis in the world
  const auto sigmas = attitude.filter().standardDeviations();   // the first three: of the orientation [rad]
  std::printf("heading %g, tilt known to %g\n", std::atan2(forward[0], forward[1]), sigmas[0]);
  EXPECT_TRUE(attitude.isStarted());
  EXPECT_NEAR(forward[0], 1, 1e-9);
  slom::filter::StrapdownState<> start;  // pose, velocity, gyro_bias, force_bias
  mtk::vect<15> sigmas_at_start;
  sigmas_at_start << 1, 1, 1, 0.05, 0.05, 0.2, 0.3, 0.3, 0.3, 0.01, 0.01, 0.01, 0.05, 0.05, 0.05;
  slom::ErrorStateFilter navigation(start, slom::StandardDeviation(sigmas_at_start));
  slom::ImuNoise imu;  // of the data sheet, without units in parts of hours
  imu.gyro = 1e-3, imu.force = 1e-2, imu.gyro_walk = 1e-5, imu.force_walk = 1e-4;
  const Vec3 gyro(0, 0, 0.1), force(0, 0, 9.81), gps(1, 2, 0), lever(0.3, 0, 0.1);
  const double dt = 0.01;
  const auto moved = navigation.predict(slom::filter::Strapdown(), slom::filter::strapdownNoise(imu, dt), gyro, force, dt);
  const auto seen = navigation.update(slom::filter::GnssPosition(), gps, lever, slom::StandardDeviation(0.5));
  if (!moved || !seen) std::puts("a step was refused");
  EXPECT_NEAR(navigation.state().pose.pos[0], 0.6, 0.1);
  slom::ErrorStateFilter robot(slom::filter::WheelState<>{}, slom::StandardDeviation(0.1));
  const slom::filter::WheelNoise<> slip;
  const mtk::vect<2> velocity(1, 0);  // forward and to the left [m/s]
  const double rate = 0.1;            // of the yaw gyroscope, or of the difference of the wheels [rad/s]
  const auto driven = robot.predict(slom::filter::WheelOdometry(), slom::filter::wheelNoise(slip, velocity, rate, dt), velocity, rate, dt);
  const auto placed = robot.update(slom::filter::PlanePosition(), mtk::vect<2>(0, 0), mtk::vect<2>(0.2, 0), slom::StandardDeviation(0.5));
  if (!driven || !placed) std::puts("a step was refused");
  EXPECT_LT(robot.state().pose.pos[0], 0.01);
}

TEST(FilterReportsPage, RunsAsShown) {
  slom::ErrorStateFilter filter(Robot{}, slom::StandardDeviation(0.1));
  mtk::vect<9> density;
  density << 0, 0, 0, 1e-6, 1e-6, 1e-6, 0.01, 0.01, 0.01;
  const auto position = [](const auto& x, const Vec3& gps) { return x.pose.pos - gps; };
  const Robot truth;
  slom::InnovationReport<3> report;  // one for each sensor, here of 3 numbers
  report.add(filter.update(position, Vec3(0.1, 0, 0), slom::StandardDeviation(0.5)));
  std::puts(report.sentence().c_str());
  slom::NeesReport errors;
  for (int run = 0; run < 10; ++run) errors.add(filter.nees(truth), filter.DOF);  // one simulated run each, at its end
  std::puts(errors.sentence().c_str());
  EXPECT_LT(errors.mean(), 1);
  slom::Observability seen(filter, "robot");  // a copy of the filter
  const auto moved = seen.predict(Move(), slom::SpectralDensity(density), Vec3(0, 0, 0.2), slom::Duration(0.1));
  const auto updated = seen.update(position, Vec3(0.1, 0, 0), slom::StandardDeviation(0.5));
  if (moved && updated) std::puts(seen.sentence().c_str());
  slom::AdaptiveNoise<3> noise{slom::StandardDeviation(0.5)};
  const auto learned = noise.update(filter, position, Vec3(0.1, 0, 0));  // as filter.update, without a noise
  if (!learned) std::puts(learned.message());
  std::printf("%g\n", noise.covariance()(0, 0));
  slom::RtsSmoother smoother(filter);  // a copy of the filter
  const auto predicted = smoother.predict(Move(), slom::SpectralDensity(density), Vec3(0, 0, 0.2), slom::Duration(0.1));
  const auto corrected = smoother.update(position, Vec3(0.1, 0, 0), slom::StandardDeviation(0.5));
  if (!predicted || !corrected) std::puts("a step was refused");
  for (const auto& [state, covariance] : smoother.smoothed()) std::printf("%g %g\n", state.pose.pos[0], covariance(0, 0));
}

TEST(FilterHistoryPage, RunsAsShown) {
  const slom::filter::StrapdownState<> start;
  slom::ErrorStateFilter navigation(start, slom::StandardDeviation(0.1));
  slom::FilterHistory<decltype(navigation), 128> history(navigation, 0.0);  // begins at 0 s
  const slom::ImuNoise imu{1e-3, 1e-2, 1e-5, 1e-4};
  for (int k = 1; k <= 100; ++k) {
    const Vec3 gyro(0, 0, 0.1), force(0, 0, 9.81);
    const auto predicted = history.predict(0.01 * k, [=](auto& f, double dt) {
      return f.predict(slom::filter::Strapdown(), slom::filter::strapdownNoise(imu, dt), gyro, force, dt);
    });
    if (predicted != slom::FilterStatus::done) std::puts(toString(predicted));
  }
  const Vec3 gps(0, 0, 0), lever(0.3, 0, 0.1);
  const auto late = history.update(0.803, [=](auto& f) {
    return f.update(slom::filter::GnssPosition(), gps, lever, slom::StandardDeviation(0.5));
  });
  if (late != slom::FilterStatus::done) std::puts(toString(late));
  std::printf("%g\n", history.filter().state().pose.pos[0]);
  EXPECT_EQ(late, slom::FilterStatus::done);
}
// clang-format on

std::string contentOf(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

void expectCodeOf(const std::string& page, std::size_t count) {
  const std::string here = contentOf(slom::testing::sourcePath("tests/filter/page_test.cpp"));
  const auto blocks = slom::testing::blocks(contentOf(slom::testing::sourcePath(page)), "cpp");
  EXPECT_EQ(blocks.size(), count);
  for (const std::string& block : blocks) EXPECT_NE(here.find(block), std::string::npos) << block;
}
TEST(FiltersPage, ShowsThisCode) {
  expectCodeOf("docs/filters.md", 3);
  expectCodeOf("docs/filter_models.md", 3);
  expectCodeOf("docs/filter_reports.md", 6);
}

}  // namespace
