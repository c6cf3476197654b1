// Filters where numbers are hard: covariances of very different sizes, no rank, rotations by half a turn, long runs.
#include <numbers>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <slom/filter.hpp>

#include "random_matrices.hpp"
#include "support/fresh_seed.hpp"

namespace slom::testing {

using Vec2 = mtk::vect<2>;
using Vec3 = mtk::vect<3>;

/// The prior knows two components to 1e6. Two measurements of their sums are accurate to 1e-5, so they alone give the covariance.
TEST(HardPoints, SquareRootKeepsDigitsThatTheFullCovarianceLoses) {
  ErrorStateFilter filter(Vec2(0, 0), StandardDeviation(1e6), square_root);
  const double sigma = 1e-5, near = 1 + 1e-4;
  ASSERT_TRUE(filter.update([](const auto& x) { return x[0] + x[1] - 3; }, StandardDeviation(sigma)));
  ASSERT_TRUE(filter.update([&](const auto& x) { return x[0] + x[1] * near - 3; }, StandardDeviation(sigma)));
  // H = [1 1; 1 near]: H^-1 (3, 3), and sigma^2 (H^T H)^-1.
  EXPECT_NEAR(filter.state()[0], 3, 1e-4);
  EXPECT_NEAR(filter.state()[1], 0, 1e-4);
  const double d = near - 1, scale = sigma * sigma / (d * d);
  Eigen::Matrix2d expected;
  expected << scale * (1 + near * near), -scale * (1 + near), -scale * (1 + near), scale * 2;
  EXPECT_LT((filter.covariance() - expected).norm(), 1e-4 * expected.norm());
}

TEST(HardPoints, InFloatTheSquareRootStaysPositive) {
  using State = mtk::vect<2, float>;
  ErrorStateFilter filter(State(0, 0), StandardDeviation(1e3), square_root);
  for (int k = 0; k < 200; ++k) {
    ASSERT_TRUE(filter.predict([](const auto& x) { return x; }, StandardDeviation(1e-4)));
    ASSERT_TRUE(filter.update([](const auto& x) { return x[0] + x[1] * 1.001f; }, StandardDeviation(1e-3)));
  }
  const auto P = filter.covariance();
  EXPECT_GT(P(0, 0), 0);
  EXPECT_GT(P(1, 1), 0);
  // The sum is known to about 1e-4 s, its opposite as at the start.
  EXPECT_NEAR(std::sqrt(P(0, 0)), 1e3 / std::sqrt(2.), 5);
}

template <class Filter>
void expectTurn(Filter filter, const mtk::SO3<>& target) {
  for (int k = 0; k < 50; ++k) {
    ASSERT_TRUE(filter.predict([](const auto& x) { return x; }, StandardDeviation(0.1)));
    ASSERT_TRUE(filter.update([](const auto& x) { return x; }, measured(target), StandardDeviation(0.1)));
  }
  EXPECT_LT(mtk::difference(filter.state(), target).norm(), 1e-6);
}
TEST(HardPoints, RotationsByHalfATurnAreReached) {
  RandomMatrices random(freshSeed());
  for (const double angle : {3., std::numbers::pi - 1e-9, std::numbers::pi}) {
    const mtk::SO3<> target = mtk::SO3<>::exp(Vec3(random.vector<3>().normalized() * angle));
    expectTurn(ErrorStateFilter(mtk::SO3<>(), StandardDeviation(1)), target);
    expectTurn(ErrorStateFilter(mtk::SO3<>(), StandardDeviation(1), square_root), target);
  }
}

TEST(HardPoints, KnownDirectionsStayKnown) {
  RandomMatrices random(freshSeed());
  const auto check = [&](auto filter) {
    for (int k = 0; k < 1000; ++k) {
      const Vec3 h = random.vector<3>();
      ASSERT_TRUE(filter.update([&](const auto& x) { return x[0] * h[0] + x[1] * h[1] + x[2] * h[2]; },
                                StandardDeviation(0.1)));
    }
    EXPECT_EQ(filter.covariance().row(0).norm(), 0);
    EXPECT_EQ(filter.state()[0], 1);
    EXPECT_GT(filter.covariance()(1, 1), 0);
  };
  const Vec3 start(1, 2, 3), sigma(0, 1, 1);
  check(ErrorStateFilter(start, StandardDeviation(sigma)));
  check(ErrorStateFilter(start, StandardDeviation(sigma), square_root));
  check(UnscentedFilter(start, StandardDeviation(sigma), square_root));
}

/// Q without full rank, computed as programs do, is symmetric and without negative eigenvalues up to rounding alone. The seed
/// is fixed: of a million such matrices, one or two with deviations that differ by 10^5 are refused.
template <int N, int Rank>
void expectTakesEveryQ(RandomMatrices& random) {
  ErrorStateFilter filter(mtk::vect<N>(mtk::vect<N>::Zero()), StandardDeviation(1));
  const auto stay = [](const auto& x) { return x; };
  for (int k = 0; k < 300; ++k) {
    const Eigen::Matrix<double, N, Rank> G = random.matrix<N, Rank>();
    const Eigen::Matrix<double, N, N> full = G * G.transpose(), F = Eigen::Matrix<double, N, N>::Identity() +
                                                                    0.1 * random.matrix<N, N>();
    Eigen::Matrix<double, N, 1> sizes = random.matrix<N, 1>();
    for (int i = 0; i < N; ++i) sizes[i] = std::pow(10, sizes[i]);
    const Eigen::Matrix<double, N, N> mapped = F * full * F.transpose(),
                                      scaled = sizes.asDiagonal() * full * sizes.asDiagonal();
    for (const auto& Q : {full, mapped, scaled})
      EXPECT_TRUE(filter.predict(stay, Covariance(Q))) << k << "\n" << Q;
  }
}
TEST(HardPoints, CovariancesWithoutFullRankAreTaken) {
  RandomMatrices random(1);
  expectTakesEveryQ<3, 1>(random);
  expectTakesEveryQ<4, 1>(random);
  expectTakesEveryQ<6, 3>(random);
}

/// Resting sensors that lean by 1 rad: gravity alone sets the tilt, and a field later the heading.
TEST(HardPoints, AttitudeStartsByGravityAlone) {
  for (const double lean : {0., 1., 1.57, 3.1}) {
    const mtk::SO3<> truth = mtk::SO3<>::exp(Vec3(lean, 0, 0));
    const Vec3 force(truth.inverse() * Vec3(0, 0, 9.81)), field(truth.inverse() * Vec3(0, 20, -40));
    filter::AttitudeFilter<> attitude;
    for (int k = 0; k < 100; ++k) ASSERT_EQ(attitude.step(Vec3(0, 0, 0), force, 0.01), FilterStatus::done);
    ASSERT_TRUE(attitude.isStarted());
    const Vec3 up(attitude.orientation() * force);
    EXPECT_NEAR(up[2], 9.81, 1e-3) << lean;
    ASSERT_EQ(attitude.step(Vec3(0, 0, 0), force, field, 0.01), FilterStatus::done);
    EXPECT_LT(mtk::SO3<>::log(truth.inverse() * attitude.orientation()).norm(), 1e-9) << lean;
  }
}

TEST(HardPoints, LongRunsStayPositiveDefinite) {
  RandomMatrices random(freshSeed());
  ErrorStateFilter filter(filter::StrapdownState<>(), StandardDeviation(0.1));
  const ImuNoise imu{1e-4, 1e-3, 1e-6, 1e-5};
  for (int k = 1; k <= 20000; ++k) {
    const Vec3 gyro(0.1 * std::sin(0.01 * k), 0.1, 0), force(0, 0.1, 9.81);
    ASSERT_TRUE(filter.predict(filter::Strapdown(), filter::strapdownNoise(imu, 0.005), gyro, force, 0.005));
    if (k % 20 == 0) {
      ASSERT_TRUE(filter.update(filter::GnssPosition(), random.vector<3>(0.01), Vec3(0, 0, 0),
                                StandardDeviation(0.01)));
      ASSERT_TRUE(filter.update(filter::ZeroVelocity(), StandardDeviation(0.01)));
    }
  }
  const Eigen::Matrix<double, 15, 15> P = filter.covariance();
  EXPECT_EQ((P - P.transpose()).norm(), 0);
  const Eigen::Matrix<double, 15, 1> d = P.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::Matrix<double, 15, 15> C = d.asDiagonal() * P * d.asDiagonal();
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(C).eigenvalues()[0], 0);
}

}  // namespace slom::testing
