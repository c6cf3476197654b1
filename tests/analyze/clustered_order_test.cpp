// Few ordered groups: the variance of an autoregressive series, against dense matrices.
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <slom/analyze/clustered.hpp>
#include <slom/slom.hpp>

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A level, measured once in each group.
struct LevelInOrder {
  slom::Estimator est;
  slom::VarID<double> level = est.insertRV(0.0, "level");
  explicit LevelInOrder(const VectorXd& y) {
    for (Index g = 0; g < y.size(); ++g)
      est.insertMeasurement([](const auto& x) { return x; }, level, slom::measured(y[g]),
                            slom::group("lap", g));
    EXPECT_TRUE(est.optimize().converged);
  }
};

VectorXd autoregressive(int n, double rho, unsigned seed) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  VectorXd y(n);
  y[0] = normal(engine);
  for (Index g = 1; g < n; ++g) y[g] = rho * y[g - 1] + std::sqrt(1 - rho * rho) * normal(engine);
  return y;
}

/// rho^|i - j|
MatrixXd correlationMatrix(Index n, double rho) {
  MatrixXd R(n, n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) R(i, j) = i == j ? 1 : std::pow(rho, std::abs(double(i - j)));
  }
  return R;
}

/// Returns variance of the mean and degrees of freedom, with the rho whose expected correlation about the mean is the
/// observed one.
std::pair<double, double> denseVariance(const VectorXd& y) {
  const Index n = y.size();
  const VectorXd e = y.array() - y.mean();
  const MatrixXd M = MatrixXd::Identity(n, n) - MatrixXd::Constant(n, n, 1.0 / double(n));
  const double observed = e.head(n - 1).dot(e.tail(n - 1)) / e.squaredNorm();
  const auto expected = [&](double rho) {
    const MatrixXd S = M * correlationMatrix(n, rho) * M;
    return S.diagonal(1).sum() / S.trace();
  };
  double best = 0;  // the correlation grows with rho
  for (double step = 0.475; step > 1e-5; step /= 2) {
    if (best + step <= 0.95 && expected(best + step) < observed) best += step;
  }
  const MatrixXd R = correlationMatrix(n, best);
  const double variance = e.squaredNorm() / (M * R).trace();  // of one number
  const double tau = (1 + best) / (1 - best), dof = double(n) / (1.5 + 4 * (tau - 1));
  return {variance * R.sum() / double(n * n), std::max(1.0, dof)};
}

TEST(ClusteredInOrder, OfFewGroupsIsAutoregressive) {
  for (const int n : {6, 10, 20, 31}) {
    for (const double rho : {0.0, 0.6, 0.9}) {
      const VectorXd y = autoregressive(n, rho, unsigned(n));
      const LevelInOrder fit(y);
      const slom::Clustered c = slom::clustered(fit.est, {.ordered = true});
      const auto [variance, dof] = denseVariance(y);
      EXPECT_NEAR(c.covariance(fit.level)(0, 0), variance, 2e-3 * variance) << n << " " << rho;
      EXPECT_NEAR(c.degreesOfFreedom(fit.level)[0], dof, 2e-3 * dof) << n << " " << rho;
      EXPECT_EQ(c.blockLength(fit.level), 1);
    }
  }
}

TEST(ClusteredInOrder, SaysWhatGroupsAreWorth) {
  const LevelInOrder alike(autoregressive(24, 0.9, 3)), independent(autoregressive(60, 0, 4));
  const std::vector<std::string> notes = slom::clustered(alike.est, {.ordered = true}).notes(alike.level);
  ASSERT_EQ(notes.size(), 2U);
  EXPECT_EQ(
      notes[0],
      "there are only 24 groups by lap in order: if neighbours are much alike, intervals hold less often "
      "than stated; 60 "
      "are better");
  EXPECT_EQ(
      notes[1],
      "successive groups are so alike that together they count as fewer than 10 independent groups, and "
      "intervals hold less often than stated: level (correlation 0.71)");
  EXPECT_TRUE(slom::clustered(independent.est, {.ordered = true}).notes(independent.level).empty());
}

/// All contributions are 0, or of opposite signs in turn.
TEST(ClusteredInOrder, OfSeriesWithoutCorrelation) {
  const LevelInOrder none(VectorXd::Constant(12, 1.0));
  EXPECT_NEAR(slom::clustered(none.est, {.ordered = true}).standardDeviation(none.level)[0], 0, 1e-12);
  VectorXd turns(12);
  for (Index g = 0; g < 12; ++g) turns[g] = g % 2 == 0 ? 1 : -1;
  const LevelInOrder opposite(turns);
  const slom::Clustered c = slom::clustered(opposite.est, {.ordered = true});
  EXPECT_NEAR(c.covariance(opposite.level)(0, 0), 1.0 / 11, 1e-9);  // as of independent ones
}

}  // namespace
