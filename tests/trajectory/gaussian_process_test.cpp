// Gaussian processes in an estimator: regression with the kernel of the process, coverage and growth, clocks with an
// offset, and whether covariances hold.
#include <cmath>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include <slom/slom.hpp>

#include "support/message_of.hpp"
#include "trajectory/random_segments.hpp"

namespace slom {
namespace {

using testing::messageOf;
using trajectory::insertMeasurement;
using trajectory::Knots;
using trajectory::poseDensity;
using trajectory::PoseProcess;
using trajectory::RotationProcess;
using trajectory::VectorProcess;
using trajectory::WhiteNoise;
using Pose = mtk::trafo<mtk::SO3<>>;
using Vec3 = mtk::vect<3>;

const auto kProcessValue = [](const auto& x, double t) { return x.at(t); };

/// The kernel of a process of one component with K parts: covariances of derivatives at two times. The state at `start`
/// has the variances `first`.
template <int K>
struct Kernel {
  double start, density;
  std::array<double, std::size_t{K}> first;

  /// Covariance of derivative i at time a and derivative j at time b.
  double operator()(int i, double a, int j, double b) const {
    const auto power = [](double x, int n) { return n < 0 ? 0 : std::pow(x, n) / std::tgamma(n + 1); };
    double sum = 0;
    for (int k = 0; k < K; ++k) {
      sum += first[std::size_t(k)] * power(a - start, k - i) * power(b - start, k - j);
    }
    // The integral of the noise until the earlier time: a polynomial of degree up to 4, by Gauss and Legendre's rule.
    const double half = (std::min(a, b) - start) / 2, root = std::sqrt(0.6);
    const double points[] = {-root, 0, root}, weights[] = {5.0 / 9, 8.0 / 9, 5.0 / 9};
    for (int p = 0; p < 3; ++p) {
      const double s = start + half * (1 + points[p]);
      sum += density * half * weights[p] * power(a - s, K - 1 - i) * power(b - s, K - 1 - j);
    }
    return sum;
  }
};

template <WhiteNoise W>
void expectRegression(unsigned seed) {
  constexpr int K = static_cast<int>(W);
  mtk::testing::Random random(seed);
  const std::vector<double> times = testing::randomTimes(random, 15);
  constexpr double sigma = 0.3;
  const Kernel<K> kernel{times.front(), 0.8, [] {
                           std::array<double, std::size_t{K}> first;
                           for (int k = 0; k < K; ++k) first[std::size_t(k)] = 4.0 / (1 + k);
                           return first;
                         }()};
  // The estimator: a state at each time, measurements at two of three times.
  Estimator est;
  VectorProcess<1, W> x(Knots(times), mtk::vect<1>(kernel.density), "x");
  x.extend(est, times.front(), times.back());
  using State = std::remove_cvref_t<decltype(*x.controls()[0])>;
  est.insertMeasurement([](const auto& state) { return state; }, x.controls()[0], measured(State()),
                        Covariance(Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(kernel.first.data(), K))
                                       .asDiagonal()
                                       .toDenseMatrix()));
  std::vector<double> seen, data;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (i % 3 == 1) continue;
    seen.push_back(times[i]);
    data.push_back(3 * random.normal());
    insertMeasurement(est, kProcessValue, x.around(times[i]), times[i], measured(mtk::vect<1>(data.back())),
                      StandardDeviation(sigma));
  }
  const Summary summary = est.optimize();
  EXPECT_TRUE(summary.converged) << summary.message;

  // Regression with the kernel.
  const auto n = static_cast<Eigen::Index>(seen.size());
  Eigen::MatrixXd G(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) G(i, j) = kernel(0, seen[std::size_t(i)], 0, seen[std::size_t(j)]);
  }
  G.diagonal().array() += sigma * sigma;
  const Eigen::LLT<Eigen::MatrixXd> factor(G);
  const Eigen::VectorXd z = Eigen::Map<const Eigen::VectorXd>(data.data(), n);
  const auto crossed = [&](int derivative, double t) {
    Eigen::VectorXd k(n);
    for (Eigen::Index i = 0; i < n; ++i) k[i] = kernel(derivative, t, 0, seen[std::size_t(i)]);
    return k;
  };
  const auto mean = [&](int derivative, double t) { return crossed(derivative, t).dot(factor.solve(z)); };
  for (std::size_t i = 0; i + 1 < times.size(); ++i) {
    for (const double part : {0.0, 0.37, 0.8}) {
      const double t = times[i] + part * (times[i + 1] - times[i]);
      const auto segment = x.segmentAt(t);
      EXPECT_NEAR(segment.at(t)[0], mean(0, t), 1e-9);
      EXPECT_NEAR(segment.velocityAt(t)[0], mean(1, t), 1e-9);
      if constexpr (K == 3) {
        EXPECT_NEAR(segment.accelerationAt(t)[0], mean(2, t), 1e-9);
      }
    }
  }
  for (std::size_t i = 0; i < times.size(); ++i) {
    const Eigen::MatrixXd C = est.covariance(x.controls()[i]);
    for (int a = 0; a < K; ++a) {
      for (int b = 0; b < K; ++b) {
        const double expected =
            kernel(a, times[i], b, times[i]) - crossed(a, times[i]).dot(factor.solve(crossed(b, times[i])));
        EXPECT_NEAR(C(a, b), expected, 1e-9) << "state " << i;
      }
    }
  }
}

TEST(GaussianProcess, IsRegressionWithItsKernel) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    expectRegression<WhiteNoise::on_acceleration>(seed);
    expectRegression<WhiteNoise::on_jerk>(seed);
  }
}

TEST(GaussianProcess, HasAPriorBetweenAllStates) {
  Estimator est;
  PoseProcess<WhiteNoise::on_jerk> pose(Knots(0, 0.5), poseDensity(2, 3), "pose");
  pose.extend(est, 0.7, 3);
  EXPECT_EQ(pose.firstTime(), 0.5);
  EXPECT_EQ(pose.lastTime(), 3);
  EXPECT_EQ(pose.controls().size(), 6u);
  EXPECT_EQ(est.getM(), 5 * 18);
  pose.extend(est, -1, 4);
  EXPECT_EQ(pose.controls().size(), 11u);
  EXPECT_EQ(est.getM(), 10 * 18);
  pose.tieEnds(est);  // the prior determines the ends
  EXPECT_EQ(est.getM(), 10 * 18);
  const auto at = [](const auto& p, double t) { return p.poseAt(t); };
  insertMeasurement(est, at, pose.around(1.25), 1.25, measured(Pose()));
  pose.trim(est);
  EXPECT_EQ(pose.firstTime(), 1);
  EXPECT_EQ(pose.lastTime(), 1.5);
  EXPECT_EQ(est.getM(), 18 + 6);
  pose.extend(est, 0, 3);
  EXPECT_EQ(est.getM(), 6 * 18 + 6);
  EXPECT_EQ(est.nameOf(pose.controls()[0]), "pose[0]");
}

TEST(GaussianProcess, ContinuesTheMotion) {
  Estimator est;
  RotationProcess<WhiteNoise::on_acceleration> R(Knots(0, 0.5), Vec3(1, 1, 1), "R");
  R.extend(est, 0, 0.5, [](double t) { return mtk::SO3<>::exp(t * Vec3(0.3, -0.1, 0.7)); });
  est.reinitRV(R.controls()[1], {R.controls()[1]->value, Vec3(0.3, -0.1, 0.7)});
  R.extend(est, 0, 7);
  EXPECT_LT(mtk::difference(R.segmentAt(6.2).orientationAt(6.2), mtk::SO3<>::exp(6.2 * Vec3(0.3, -0.1, 0.7)))
                .norm(),
            1e-12);
}

TEST(GaussianProcess, RefusesTimesThatItDoesNotCover) {
  Estimator est;
  VectorProcess<1, WhiteNoise::on_jerk> x(Knots(0, 1), mtk::vect<1>(1.0), "height");
  x.extend(est, 0, 10);
  EXPECT_EQ(
      messageOf(
          [&] { insertMeasurement(est, kProcessValue, x.around(11.5), 11.5, measured(mtk::vect<1>(1.0))); }),
      "[slom.uncovered-time] spline height covers the times from 0 to 10, and the time is 11.5; call extend(est, "
      "from, to) first");
}

TEST(GaussianProcess, MeasurementsFollowTheirTimes) {
  Estimator est;
  VectorProcess<1, WhiteNoise::on_jerk> x(Knots(0, 1), mtk::vect<1>(1.0), "x");
  const auto offset = est.insertRV(0.0, "offset");
  x.extend(est, 0, 10);
  const auto f = [](const auto& segment, const auto& by, double t) { return segment.at(t + by); };
  const auto placed =
      insertMeasurement(est, f, x.around(2.5, offset), offset, 2.5, measured(mtk::vect<1>(1.0)));
  for (const double by : {700.25, -1000.5, 0.0}) {
    est.reinitRV(offset, by);
    while (x.follow(est) > 0) {
    }
    EXPECT_FALSE(x.isLeft());
    EXPECT_LE(x.firstTime(), 2.5 + by);
    EXPECT_GE(x.lastTime(), 2.5 + by);
    EXPECT_EQ(x.controls().size(), 2u);  // trimmed to the only segment with a measurement
    EXPECT_EQ(est.getM(), 3 + 1);
  }
  EXPECT_EQ(est.residual(placed.id()).size(), 1);
}

/// A motion drawn from the prior itself, in steps of 2 ms.
class DrawnMotion {
 public:
  using State = trajectory::PoseProcessSegment<WhiteNoise::on_jerk>::Control;
  static constexpr double kStep = 0.002, kDuration = 4, kLinear = 0.5, kAngular = 0.5;

  explicit DrawnMotion(mtk::testing::Random& random) {
    const trajectory::MotionPrior<WhiteNoise::on_jerk, mtk::SO3<>> linear(kStep,
                                                                          Vec3(kLinear, kLinear, kLinear)),
        angular(kStep, Vec3(kAngular, kAngular, kAngular));
    const Eigen::Matrix<double, 9, 9> P = linear.covariance().llt().matrixL(),
                                      R = angular.covariance().llt().matrixL();
    State state;
    for (double t = 0; t < kDuration + 2 * kStep; t += kStep) {
      states_.push_back(state);
      add(state.position, P, random);
      add(state.orientation, R, random);
    }
  }
  /// The state at a time of the grid.
  const State& at(double t) const { return states_[std::size_t(std::lround(t / kStep))]; }

 private:
  static void add(auto& state, const Eigen::Matrix<double, 9, 9>& L, mtk::testing::Random& random) {
    auto next = trajectory::detail::seenFrom(state.value, trajectory::detail::predicted(state, kStep));
    Eigen::Matrix<double, 9, 1> white;
    for (auto& x : white) x = random.normal();
    const Eigen::Matrix<double, 9, 1> noise = L * white;
    for (std::size_t k = 0; k < 3; ++k) next[k] += noise.segment<3>(3 * Eigen::Index(k));
    state = trajectory::detail::stateAt(state.value, next);
  }
  std::vector<State> states_;
};

/// A camera, and an IMU with biases whose clock has an offset: none measures at the time of a state.
struct AsynchronousFit {
  static constexpr double kPoseSigma = 0.005, kGyroSigma = 0.02, kForceSigma = 0.2, kSpacing = 0.05;
  Estimator est;
  PoseProcess<WhiteNoise::on_jerk> pose{Knots(0, kSpacing),
                                        poseDensity(DrawnMotion::kLinear, DrawnMotion::kAngular), "pose"};
  VarID<double> offset;
  VarID<Vec3> bias;
  Summary summary;

  AsynchronousFit(const DrawnMotion& truth, double true_offset, mtk::testing::Random& random) {
    const auto noise = [&](double sigma) { return testing::randomVector(random, sigma); };
    const Vec3 g(0, 0, 9.81), true_bias(0.02, -0.01, 0.03);
    pose.extend(est, 0, DrawnMotion::kDuration, [&](double t) { return truth.at(t).pose(); });
    const auto seen = [](const auto& p, double t) { return p.poseAt(t); };
    const auto gyro = [](const auto& p, const auto& by, const auto& b, double t) {
      return p.angularVelocityAt(t + by) + b;
    };
    const auto accelerometer = [g](const auto& p, const auto& by, double t) {
      return p.bodyAccelerationAt(t + by) + p.orientationAt(t + by).inverse() * g;
    };
    for (double t = 0.018; t < DrawnMotion::kDuration; t += 0.066) {
      const Pose at = truth.at(t).pose();
      insertMeasurement(
          est, seen, pose.around(t), t,
          measured(Pose(Vec3(at.pos + noise(kPoseSigma)), at.orient * mtk::SO3<>::exp(noise(kPoseSigma)))),
          StandardDeviation(kPoseSigma), named("camera"));
    }
    EXPECT_TRUE(est.optimize().converged);  // the camera alone
    offset = est.insertRV(0.0, "offset");
    bias = est.insertRV(Vec3(), "bias");
    for (double t = 0.206; t < DrawnMotion::kDuration - 0.2; t += 0.01) {
      const auto& at = truth.at(t + true_offset);
      insertMeasurement(est, gyro, pose.around(t, offset), offset, bias, t,
                        measured(Vec3(at.orientation.velocity + true_bias + noise(kGyroSigma))),
                        StandardDeviation(kGyroSigma), named("gyro"));
      insertMeasurement(est, accelerometer, pose.around(t, offset), offset, t,
                        measured(Vec3(at.pose().orient.inverse() * Vec3(at.position.acceleration + g) +
                                      noise(kForceSigma))),
                        StandardDeviation(kForceSigma), named("accelerometer"));
    }
    summary = trajectory::optimize(est, {pose});
  }
};

TEST(GaussianProcessFit, StandardDeviationsHold) {
  double offsets = 0, states = 0;
  int fits = 0, count = 0;
  for (const double true_offset : {0.004, -0.13, 0.15}) {  // up to 3 spacings
    for (unsigned seed = 0; seed < 4; ++seed) {
      SCOPED_TRACE("offset " + std::to_string(true_offset) + ", seed " + std::to_string(seed));
      mtk::testing::Random random(seed);
      const DrawnMotion truth(random);
      AsynchronousFit fit(truth, true_offset, random);
      EXPECT_TRUE(fit.summary.converged) << fit.summary.message;
      EXPECT_NEAR(fit.summary.chi2PerDof(), 1, 0.12);
      const double sigma = fit.est.standardDeviation(fit.offset)[0];
      EXPECT_LT(sigma, 2e-3);
      const double error = (*fit.offset - true_offset) / sigma;
      EXPECT_LT(std::abs(error), 4);
      offsets += error * error;
      ++fits;
      for (std::size_t i = 10; i < fit.pose.controls().size() - 10; i += 20) {
        const auto& id = fit.pose.controls()[i];
        const Eigen::Matrix<double, 18, 1> d =
            mtk::difference(*id, truth.at(AsynchronousFit::kSpacing * double(i)));
        states += d.dot(fit.est.covariance(id).ldlt().solve(d)) / 18;
        ++count;
      }
    }
  }
  EXPECT_LT(offsets / fits, 2.4);  // chi-square / 12 at 99.5 %
  EXPECT_GT(offsets / fits, 0.25);
  EXPECT_NEAR(states / count, 1, 0.15);
}

TEST(GaussianProcessFit, DerivativesAgreeWithDifferences) {
  mtk::testing::Random random(1);
  const DrawnMotion truth(random);
  AsynchronousFit fit(truth, 0.05, random);
  fit.est.reinitRV(fit.offset, 0.0472);
  const DerivativeCheck check = checkDerivatives(fit.est);
  // At the time of a state, the block of the other state is 0, and differences leave rounding errors of it.
  constexpr double rounding = 1e-6;
  for (const GroupDerivativeCheck& group : check.groups) {
    EXPECT_EQ(group.source, DerivativeSource::exact);
    EXPECT_TRUE(group.guess.empty() || std::abs(group.used - group.reference) < rounding) << check;
  }
}

/// Rotations by small angles and vectors with the same noise.
TEST(GaussianProcessFit, OfSmallRotationsIsThatOfVectors) {
  constexpr double small = 1e-6;
  Estimator of_vectors, of_rotations;
  VectorProcess<3, WhiteNoise::on_jerk> x(Knots(0, 0.5), Vec3(1, 2, 3), "x");
  RotationProcess<WhiteNoise::on_jerk> R(Knots(0, 0.5), Vec3(small * small * Vec3(1, 2, 3)), "R");
  x.extend(of_vectors, 0, 5);
  R.extend(of_rotations, 0, 5);
  mtk::testing::Random random(2);
  const auto orientation = [](const auto& segment, double t) { return segment.orientationAt(t); };
  for (double t = 0.1; t < 5; t += 0.3) {
    const Vec3 z = testing::randomVector(random, 1);
    insertMeasurement(of_vectors, kProcessValue, x.around(t), t, measured(z), StandardDeviation(0.1));
    insertMeasurement(of_rotations, orientation, R.around(t), t, measured(mtk::SO3<>::exp(small * z)),
                      StandardDeviation(0.1 * small));
  }
  const Summary a = of_vectors.optimize(), b = of_rotations.optimize();
  EXPECT_NEAR(b.final_rss, a.final_rss, 1e-5 * a.final_rss);
  for (double t = 0; t <= 5; t += 0.2) {
    EXPECT_LT((mtk::SO3<>::log(R.segmentAt(t).orientationAt(t)) / small - x.segmentAt(t).at(t)).norm(), 1e-5);
    EXPECT_LT((R.segmentAt(t).angularAccelerationAt(t) / small - x.segmentAt(t).accelerationAt(t)).norm(),
              1e-4);
  }
}

}  // namespace
}  // namespace slom
