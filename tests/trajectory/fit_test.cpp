// Whole fits: poses from a camera, a gyroscope with a bias and an accelerometer whose clock has an unknown offset.
#include <cmath>

#include <gtest/gtest.h>

#include <slom/slom.hpp>

#include "trajectory/random_segments.hpp"

namespace slom {
namespace {

using Pose = mtk::trafo<mtk::SO3<>>;
using Vec3 = mtk::vect<3>;
using trajectory::insertMeasurement;
using trajectory::Knots;

/// A motion with known rates: exp(a u) exp(b v) with constant unit vectors, and a sum of sines.
struct Motion {
  static Vec3 position(double t) {
    return {2 * std::cos(0.7 * t), std::sin(1.1 * t), 0.5 * std::sin(1.6 * t)};
  }
  static Vec3 acceleration(double t) {
    return {-0.98 * std::cos(0.7 * t), -1.21 * std::sin(1.1 * t), -1.28 * std::sin(1.6 * t)};
  }
  static mtk::SO3<> orientation(double t) {
    return mtk::SO3<>::exp(0.9 * std::sin(1.4 * t) * u()) * mtk::SO3<>::exp(1.1 * std::sin(1.9 * t) * v());
  }
  static Vec3 angularVelocity(double t) {
    const mtk::SO3<> second = mtk::SO3<>::exp(1.1 * std::sin(1.9 * t) * v());
    return second.inverse() * (1.26 * std::cos(1.4 * t) * u()) + 2.09 * std::cos(1.9 * t) * v();
  }
  static Vec3 u() { return {0.6, 0, 0.8}; }
  static Vec3 v() { return {0, 1, 0}; }
};

constexpr double kDuration = 8, kPoseSigma = 0.005, kGyroSigma = 0.01, kAccelerometerSigma = 0.05;
const Vec3 kGravity(0, 0, 9.81);  // an accelerometer at rest reads upwards
const Vec3 kBias(0.1, -0.2, 0.05);

template <class PoseSpline>
struct Fit {
  Estimator est;
  PoseSpline pose;
  trajectory::VectorSpline<3, 3> bias{Knots(0, 4), "bias"};
  VarID<double> offset;
  mtk::testing::Random random;

  Fit(const Knots& knots, unsigned seed) : pose(knots, "pose"), random(seed) {
    pose.extend(est, 0, kDuration, [&](double t) {  // roughly
      return Pose(Vec3(Motion::position(t) + noise(0.02)),
                  Motion::orientation(t) * mtk::SO3<>::exp(noise(0.02)));
    });
  }
  Vec3 noise(double sigma) { return testing::randomVector(random, sigma); }

  void insertPoses() {
    const auto seen = [](const auto& segment, double t) { return segment.poseAt(t); };
    for (int i = 0; i <= 200; ++i) {
      const double t = 0.01 + (kDuration - 0.02) * i / 200;
      const Pose datum(Vec3(Motion::position(t) + noise(kPoseSigma)),
                       Motion::orientation(t) * mtk::SO3<>::exp(noise(kPoseSigma)));
      insertMeasurement(est, seen, pose.around(t), t, measured(datum), StandardDeviation(kPoseSigma),
                        named("camera"));
    }
  }
  /// Readings whose stamps are `truth` too small, from the first stamp on.
  void insertReadings(double truth, double first = 0.005, double step = 0.01) {
    offset = est.insertRV(0.0, "offset");
    bias.extend(est, 0, kDuration);
    const auto gyro = [](const auto& p, const auto& b, const auto& by, double stamp) {
      return p.angularVelocityAt(stamp + by) + b.at(stamp + by);
    };
    const auto accelerometer = [](const auto& p, const auto& by, double stamp) {
      return p.bodyAccelerationAt(stamp + by) + p.orientationAt(stamp + by).inverse() * kGravity;
    };
    for (double t = first; t <= kDuration; t += step) {
      const double at = t + truth;
      const Vec3 w = Motion::angularVelocity(at) + kBias + noise(kGyroSigma);
      insertMeasurement(est, gyro, pose.around(t, offset), bias.around(t, offset), offset, t, measured(w),
                        StandardDeviation(kGyroSigma), named("gyro"));
      const Vec3 a = Motion::orientation(at).inverse() * Vec3(Motion::acceleration(at) + kGravity) +
                     noise(kAccelerometerSigma);
      insertMeasurement(est, accelerometer, pose.around(t, offset), offset, t, measured(a),
                        StandardDeviation(kAccelerometerSigma), named("accelerometer"));
    }
  }
};

/// Returns the error of the offset in standard deviations.
template <class PoseSpline>
double normalizedError(const Knots& knots, double truth, unsigned seed) {
  Fit<PoseSpline> fit(knots, seed);
  fit.insertPoses();
  fit.pose.tieEnds(fit.est);
  const Summary start = fit.est.optimize();  // the camera alone
  EXPECT_TRUE(start.converged) << start.message;
  fit.insertReadings(truth);
  const Summary summary = trajectory::optimize(fit.est, {fit.pose, fit.bias});
  EXPECT_TRUE(summary.converged) << summary.message;
  EXPECT_EQ(summary.warnings.size(), 0u);
  EXPECT_NEAR(summary.chi2PerDof(), 1, 0.1);
  EXPECT_FALSE(fit.pose.isLeft());
  EXPECT_LT((fit.bias.segmentAt(4).at(4) - kBias).norm(), 0.01);
  const double sigma = fit.est.standardDeviation(fit.offset)[0];
  EXPECT_LT(sigma, 1e-3);
  return (*fit.offset - truth) / sigma;
}

TEST(TrajectoryFit, FindsTheOffsetOfAClock) {
  const Knots knots(0, 0.2);
  double squares = 0;
  int fits = 0;
  for (const double truth : {0.003, -0.1, 0.37, -0.55}) {  // up to 3 spacings of the knots
    for (unsigned seed = 0; seed < 3; ++seed) {
      const double error = normalizedError<trajectory::PoseSpline<5>>(knots, truth, seed);
      EXPECT_LT(std::abs(error), 4) << "offset " << truth << ", seed " << seed;
      squares += error * error;
      ++fits;
    }
  }
  EXPECT_LT(squares / fits, 2.3);  // chi-square / 12 at 99.5 %
  EXPECT_GT(squares / fits, 0.25);
}

/// A slow motion, and a second clock that is 2 s late: 40 spacings of the knots.
TEST(TrajectoryFit, FindsAnOffsetOfManySegments) {
  const auto truth = [](double t) { return Vec3(std::sin(0.3 * t), std::cos(0.25 * t), 0.1 * t); };
  const auto position = [](const auto& x, double t) { return x.at(t); };
  const auto late = [](const auto& x, const auto& by, double stamp) { return x.at(stamp + by); };
  for (const double offset : {2.0, -2.0, 0.3}) {
    for (unsigned seed = 0; seed < 2; ++seed) {
      SCOPED_TRACE("offset " + std::to_string(offset) + ", seed " + std::to_string(seed));
      mtk::testing::Random random(seed);
      Estimator est;
      trajectory::VectorSpline<3, 4> x(Knots(0, 0.05), "x");
      x.extend(est, 0, 20, truth);
      const auto by = est.insertRV(0.0, "offset");
      for (int i = 0; i <= 2000; ++i) {
        const double t = 0.01 * i;
        insertMeasurement(est, position, x.around(t), t,
                          measured(Vec3(truth(t) + testing::randomVector(random, 1e-4))),
                          StandardDeviation(1e-4));
        insertMeasurement(est, late, x.around(t, by), by, t,
                          measured(Vec3(truth(t + offset) + testing::randomVector(random, 1e-4))),
                          StandardDeviation(1e-4));
      }
      const Summary summary = trajectory::optimize(est, {x});
      EXPECT_TRUE(summary.converged) << summary.message;
      EXPECT_NEAR(summary.chi2PerDof(), 1, 0.05);
      const double sigma = est.standardDeviation(by)[0];
      EXPECT_LT(sigma, 2e-5);
      EXPECT_LT(std::abs(*by - offset), 4 * sigma);
    }
  }
}

TEST(TrajectoryFit, OnSE3AndWithNonUniformKnots) {
  std::vector<double> times;
  for (int i = 0; i <= 40; ++i) times.push_back(0.2 * i + (i % 2 == 0 ? 0 : 0.03));
  EXPECT_LT(std::abs(normalizedError<trajectory::ScrewSpline<6>>(Knots(0, 0.2), 0.37, 7)), 4);
  EXPECT_LT(std::abs(normalizedError<trajectory::ScrewSpline<6>>(Knots(times), -0.37, 8)), 4);
  EXPECT_LT(std::abs(normalizedError<trajectory::PoseSpline<5>>(Knots(times), 0.37, 9)), 4);
}

TEST(TrajectoryFit, DerivativesAgreeWithDifferences) {
  Fit<trajectory::PoseSpline<5>> fit(Knots(0, 0.2), 3);
  fit.insertReadings(0.1, 0.1, 0.2);  // in the middle of segments, where no weight is nearly 0
  fit.est.reinitRV(fit.offset, 0.0123);
  const DerivativeCheck check = checkDerivatives(fit.est);
  ASSERT_EQ(check.groups.size(), 2u);
  for (const GroupDerivativeCheck& group : check.groups) EXPECT_EQ(group.source, DerivativeSource::exact);
  EXPECT_TRUE(check.ok()) << check;
}

TEST(TrajectoryFit, OfConstantTimesIsAnOrdinaryFit) {
  Fit<trajectory::PoseSpline<5>> fit(Knots(0, 0.5), 4);
  fit.insertPoses();
  Estimator same = fit.est.clone();
  const Summary a = trajectory::optimize(fit.est, {fit.pose}), b = same.optimize();
  EXPECT_TRUE(a.converged);
  EXPECT_EQ(a.final_rss, b.final_rss);
  EXPECT_EQ(a.initial_rss, b.initial_rss);
  EXPECT_EQ(a.iterations, b.iterations);
}

TEST(TrajectoryFit, StopsWhenTheUserSaysSo) {
  Fit<trajectory::PoseSpline<5>> fit(Knots(0, 0.2), 5);
  fit.insertPoses();
  fit.est.optimize();
  fit.insertReadings(0.37);
  int calls = 0;
  Options options;
  options.observer = [&](const IterationRecord&) {
    return ++calls == 3 ? FitControl::stop : FitControl::go_on;
  };
  const Summary stopped = trajectory::optimize(fit.est, {fit.pose}, options);
  EXPECT_FALSE(stopped.converged);
  EXPECT_EQ(calls, 3);
  const Summary limited = trajectory::optimize(fit.est, {fit.pose}, {.max_iterations = 2});
  EXPECT_FALSE(limited.converged);
  EXPECT_LE(limited.iterations, 2);
}

}  // namespace
}  // namespace slom
