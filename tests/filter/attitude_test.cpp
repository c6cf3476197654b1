// The attitude filter on simulated readings: it finds orientation and bias, and notices wrong units without false alarms.
#include <cmath>

#include <gtest/gtest.h>

#include <slom/filter.hpp>

#include "random_matrices.hpp"
#include "support/fresh_seed.hpp"

namespace slom::testing {

using Vec3 = mtk::vect<3>;
using Orientation = mtk::SO3<>;

/// How a body moves: turns, shakes, and what the sensors do with that.
struct Ride {
  double rate = 0.5;          ///< amplitude of the angular velocity [rad/s]
  double acceleration = 0.3;  ///< amplitude [m/s^2]
  double gravity = 9.81;      ///< felt [m/s^2]; 0 in free fall
  double force_unit = 1, rate_unit = 1;
  bool hangs = false;       ///< the accelerometer keeps its first reading
  bool swaps_axes = false;  ///< of the gyroscope
  bool about_vertical = false;
  int steps = 3000;        ///< of 0.01 s
  int mirror = -1;         ///< axis of the magnetometer that is reversed
  int swap = -1;           ///< axis that is swapped with the next one
  double disturbance = 0;  ///< of the field, in the world [unit of the field], changes within seconds
  double hard_iron = 0;    ///< in the body
};

/// Runs the filter, for 30 s if not stated; returns the first status that is not done, with the error at the end in `error` [rad].
FilterStatus ride(const Ride& r, filter::AttitudeFilter<>& attitude, double* error = nullptr) {
  RandomMatrices random(3);
  const double dt = 0.01;
  Orientation truth = Orientation::exp(r.about_vertical ? Vec3(0, 0, 0) : Vec3(0.3, -0.2, 1));
  Vec3 first(0, 0, 0);
  for (int k = 0; k < r.steps; ++k) {
    const double t = k * dt;
    const Vec3 turn = r.about_vertical ? Vec3(0, 0, r.rate)
                                       : Vec3(r.rate * std::sin(1.1 * t), r.rate * std::cos(0.7 * t),
                                              r.rate * std::sin(0.4 * t));
    truth = truth * Orientation::exp(Vec3(turn * dt));
    const Vec3 moved(r.acceleration * std::sin(7 * t), r.acceleration * std::cos(9 * t),
                     r.acceleration * std::sin(5 * t));
    Vec3 force(truth.inverse() * Vec3(moved + Vec3(0, 0, r.gravity)) + random.vector<3>(0.05));
    const Vec3 disturbed(std::sin(0.9 * t), std::cos(1.7 * t), std::sin(0.3 * t));
    Vec3 field(truth.inverse() * Vec3(Vec3(0, 20, -40) + r.disturbance * disturbed) +
               r.hard_iron * Vec3(1, -0.7, 0.4) + random.vector<3>(0.1));
    if (r.mirror >= 0) field[r.mirror] *= -1;
    if (r.swap >= 0) std::swap(field[r.swap], field[(r.swap + 1) % 3]);
    if (k == 0) first = force;
    if (r.hangs) force = first;
    Vec3 gyro(turn + random.vector<3>(0.002));
    if (r.swaps_axes) gyro = Vec3(gyro[1], -gyro[0], gyro[2]);
    const auto before = attitude.filter().covariance();
    const FilterStatus status =
        attitude.step(Vec3(gyro * r.rate_unit), Vec3(force * r.force_unit), field, dt);
    if (status != FilterStatus::done) {
      EXPECT_EQ(attitude.filter().covariance(), before);
      return status;
    }
  }
  if (error != nullptr) *error = Orientation::log(truth.inverse() * attitude.orientation()).norm();
  return FilterStatus::done;
}
FilterStatus ride(const Ride& r, double* error = nullptr) {
  filter::AttitudeFilter<> attitude;
  return ride(r, attitude, error);
}

TEST(AttitudeFilter, FindsTheOrientation) {
  double error = 1;
  EXPECT_EQ(ride({}, &error), FilterStatus::done);
  EXPECT_LT(error, 0.02);
}

constexpr double kG = 1 / 9.80665, kDegrees = 180 / 3.14159265358979;

TEST(AttitudeFilter, NoticesForcesInG) {
  EXPECT_EQ(ride({.force_unit = kG}), FilterStatus::force_in_g);
  EXPECT_EQ(ride({.rate = 0, .acceleration = 0, .force_unit = kG}), FilterStatus::force_in_g);
  EXPECT_EQ(ride({.rate = 5, .acceleration = 2, .force_unit = kG}), FilterStatus::force_in_g);
  EXPECT_STREQ(
      toString(FilterStatus::force_in_g),
      "the first specific forces have a length of about 1, as in g; pass m/s^2, which is g times 9.80665, or set "
      "the gravity of the noise to what the accelerometer reads at rest");
  filter::AttitudeNoise<> in_g;  // then all is consistent
  in_g.gravity = 1;
  filter::AttitudeFilter<> attitude(in_g);
  EXPECT_EQ(ride({.force_unit = kG}, attitude), FilterStatus::done);
  filter::AttitudeFilter<> trusting;
  trusting.trustUnits();
  EXPECT_EQ(ride({.force_unit = kG}, trusting), FilterStatus::done);
}

TEST(AttitudeFilter, NoticesRatesInDegrees) {
  for (const double rate : {0.2, 0.5, 2., 10.}) {
    EXPECT_EQ(ride({.rate = rate, .rate_unit = kDegrees}), FilterStatus::rate_in_degrees) << rate;
  }
  for (const double rate : {0.1, 0.2, 0.5, 2., 10.}) {
    EXPECT_EQ(ride({.rate = rate, .rate_unit = kDegrees, .about_vertical = true, .steps = 9000}),
              FilterStatus::rate_in_degrees)
        << rate;
  }
  EXPECT_STREQ(
      toString(FilterStatus::rate_in_degrees),
      "the angular velocities fit the turns of the specific force or the field in degrees per second, or are faster than a "
      "MEMS gyroscope; pass rad/s, which is degrees per second times 0.0174533");
}

TEST(AttitudeFilter, NoticesAMagnetometerOfTheOtherHand) {
  for (const double rate : {0.2, 0.5, 2., 10.}) {
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(ride({.rate = rate, .mirror = axis}), FilterStatus::field_axes_differ) << rate << axis;
      EXPECT_EQ(ride({.rate = rate, .swap = axis}), FilterStatus::field_axes_differ) << rate << axis;
    }
    EXPECT_EQ(ride({.rate = rate, .about_vertical = true, .mirror = 0}), FilterStatus::field_axes_differ);
    EXPECT_EQ(ride({.rate = rate, .about_vertical = true, .mirror = 1}), FilterStatus::field_axes_differ);
  }
  filter::AttitudeFilter<> trusting;
  trusting.trustUnits();
  EXPECT_EQ(ride({.mirror = 0}, trusting), FilterStatus::done);
}

TEST(AttitudeFilter, TakesDisturbedFields) {
  for (const double rate : {0., 0.02, 0.2, 1., 5., 20.}) {
    for (const bool about_vertical : {false, true}) {
      for (const double size : {5., 20., 40., 80., 200.}) {
        EXPECT_EQ(ride({.rate = rate, .about_vertical = about_vertical, .disturbance = size}),
                  FilterStatus::done)
            << rate << ' ' << size;
        EXPECT_EQ(ride({.rate = rate, .about_vertical = about_vertical, .hard_iron = size}),
                  FilterStatus::done)
            << rate << ' ' << size;
        EXPECT_EQ(ride({.rate = rate, .about_vertical = about_vertical, .hard_iron = -size}),
                  FilterStatus::done)
            << rate << ' ' << -size;
      }
    }
  }
}

TEST(AttitudeFilter, SaysWhyItCannotStart) {
  const Vec3 zero(0, 0, 0), up(0, 0, 9.81), north(0, 20, -40);
  const double nan = std::nan("");
  filter::AttitudeFilter<> f;
  for (const double dt : {nan, 0., -1., HUGE_VAL}) {
    EXPECT_EQ(f.step(zero, up, north, dt), FilterStatus::bad_duration);
    EXPECT_EQ(f.step(zero, up, dt), FilterStatus::bad_duration);
  }
  EXPECT_EQ(f.step(zero, up, zero, 0.01), FilterStatus::no_heading);
  EXPECT_EQ(f.step(zero, up, Vec3(0, 0, -40), 0.01), FilterStatus::no_heading);
  EXPECT_EQ(f.step(zero, zero, north, 0.01), FilterStatus::no_tilt);
  EXPECT_EQ(f.step(zero, zero, 0.01), FilterStatus::no_tilt);
  EXPECT_EQ(f.step(zero, up, Vec3(0, nan, 0), 0.01), FilterStatus::data_not_finite);
  EXPECT_EQ(f.step(Vec3(nan, 0, 0), up, north, 0.01), FilterStatus::data_not_finite);
  EXPECT_FALSE(f.isStarted());
  EXPECT_EQ(f.step(zero, up, north, 0.01), FilterStatus::done);
  EXPECT_EQ(f.step(zero, up, zero, 0.01), FilterStatus::no_heading);
  EXPECT_EQ(f.step(zero, up, Vec3(0, nan, 0), 0.01), FilterStatus::data_not_finite);
  EXPECT_EQ(f.step(zero, zero, north, 0.01), FilterStatus::done);  // free fall
}

TEST(AttitudeFilter, HasNoFalseAlarms) {
  for (const double rate : {0., 0.02, 0.2, 1., 5., 20., 35.}) {
    for (const double acceleration : {0., 1., 10., 50.}) {
      for (const double gravity : {9.81, 0., 1.62}) {  // on earth, in free fall, on the moon
        const Ride r{.rate = rate, .acceleration = acceleration, .gravity = gravity};
        EXPECT_EQ(ride(r), FilterStatus::done) << rate << ' ' << acceleration << ' ' << gravity;
      }
    }
    EXPECT_EQ(ride({.rate = rate, .hangs = true}), FilterStatus::done) << rate;
    EXPECT_EQ(ride({.rate = rate, .swaps_axes = true}), FilterStatus::done) << rate;
    EXPECT_EQ(ride({.rate = rate, .about_vertical = true}), FilterStatus::done) << rate;
  }
}

}  // namespace slom::testing
