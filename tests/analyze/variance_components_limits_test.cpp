// Variance components of large problems, and messages at the limits of the iteration or the linearisation.
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <slom/analyze/variance_components.hpp>
#include <slom/slom.hpp>

#include "support/slow_with_sanitizers.hpp"

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr auto reading = [](const auto& x) { return x; };
constexpr auto step_between = [](const auto& a, const auto& b) { return b - a; };

/// A chain of heights: their own, and two measurements of each step.
struct Chain {
  slom::Estimator est;
  std::vector<slom::VarID<double>> heights;
  MatrixXd X;
  VectorXd y, kind;

  Chain(int n, double sigma_reading, double sigma_step)
      : X(MatrixXd::Zero(3 * n - 2, n)), y(X.rows()), kind(X.rows()) {
    std::mt19937 engine(6);
    std::normal_distribution<double> normal;
    for (int i = 0; i < n; ++i) heights.push_back(est.insertRV(0.0));
    Index row = 0;
    const auto note = [&](double z, int k) {
      y[row] = z;
      kind[row++] = k;
    };
    for (int i = 0; i < n; ++i) {
      const auto at = static_cast<std::size_t>(i);
      X(row, i) = 1;
      note(sigma_reading * normal(engine), 0);
      est.insertMeasurement(reading, heights[at], slom::measured(y[row - 1]), slom::named("reading"));
      for (int k = 0; k < 2 && i > 0; ++k) {
        X(row, i) = 1;
        X(row, i - 1) = -1;
        note(sigma_step * normal(engine), 1);
        est.insertMeasurement(step_between, heights[at - 1], heights[at], slom::measured(y[row - 1]),
                              slom::named("step"));
      }
    }
    EXPECT_TRUE(est.optimize().converged);
  }
};

/// Beyond 400 unknowns the information is a mean over random signs. Factors are exact; statements about them are
/// approximate.
TEST(VarianceComponentsLimits, OfALargeProblem) {
  const Chain chain(420, 2, 0.5);
  const slom::VarianceComponents v = slom::varianceComponents(chain.est);
  ASSERT_TRUE(v.converged) << v.report();
  SLOM_SKIP_WITH_SANITIZERS();  // the dense matrices below
  VectorXd theta(2);
  for (Index k = 0; k < 2; ++k) theta[k] = std::pow(v.components[static_cast<std::size_t>(k)].factor, 2);
  const VectorXd weight = chain.kind.unaryExpr([&](double k) { return 1 / theta[Index(k)]; });
  const MatrixXd WX = weight.asDiagonal() * chain.X;
  const Eigen::LLT<MatrixXd> N(chain.X.transpose() * WX);
  const MatrixXd P = MatrixXd(weight.asDiagonal()) - WX * N.solve(WX.transpose());
  const VectorXd Py = P * chain.y;
  MatrixXd S(2, 2);
  for (int k = 0; k < 2; ++k) {
    const VectorXd own = (chain.kind.array() == k).cast<double>();
    const double redundancy = theta[k] * P.diagonal().dot(own);
    EXPECT_NEAR(theta[k] * Py.cwiseAbs2().dot(own), redundancy, 1e-5 * redundancy);  // the score is 0
    EXPECT_NEAR(v.components[std::size_t(k)].redundancy, redundancy, 1e-6 * redundancy);
    for (int l = 0; l < 2; ++l) {
      const VectorXd other = (chain.kind.array() == l).cast<double>();
      S(k, l) = theta[k] * theta[l] * own.dot(P.cwiseAbs2() * other);
    }
  }
  const MatrixXd C = S.inverse();
  for (Index k = 0; k < 2; ++k) EXPECT_NEAR(v.components[std::size_t(k)].dof, 1 / C(k, k), 0.05 / C(k, k));
  ASSERT_FALSE(v.notes.empty());
  EXPECT_EQ(
      v.notes[0],
      "the problem is large: standard deviations of the factors are from random signs, and have one or two digits");
}

TEST(VarianceComponentsLimits, OfStatedDeviationsThatAreFarOff) {
  const Chain chain(20, 30, 0.1);
  const slom::VarianceComponents v = slom::varianceComponents(chain.est);
  EXPECT_GT(v.largest_move, 1);
  ASSERT_EQ(v.notes.size(), 1U);
  EXPECT_EQ(v.notes[0].substr(0, 36), "with these weights a value moves by ");
  EXPECT_EQ(v.notes[0].substr(v.notes[0].find(" of its")),
            " of its standard deviations; apply them, optimize, and estimate again");
}

TEST(VarianceComponentsLimits, OfAnIterationThatIsCutShort) {
  const Chain chain(20, 3, 0.1);
  const slom::VarianceComponents v = slom::varianceComponents(chain.est, {.max_iterations = 2});
  EXPECT_FALSE(v.converged);
  EXPECT_EQ(v.iterations, 2);
  EXPECT_EQ(v.report().substr(0, 44), "NOT converged: iteration limit of 2 reached\n");
  EXPECT_TRUE(slom::varianceComponents(chain.est).converged);
}

/// A shared error of groups that each have a free offset of their own, which takes it up.
TEST(VarianceComponentsLimits, OfASharedErrorThatValuesFollow) {
  slom::Estimator est;
  std::mt19937 engine(2);
  std::normal_distribution<double> normal;
  for (int g = 0; g < 6; ++g) {
    const auto offset = est.insertRV(0.0);
    for (int i = 0; i < 5; ++i)
      est.insertMeasurement(reading, offset, slom::measured(g + normal(engine)), slom::named("reading"),
                            slom::group("day", g));
  }
  ASSERT_TRUE(est.optimize().converged);
  const slom::VarianceComponents v = slom::varianceComponents(est, {.shared = {{"reading", "day"}}});
  EXPECT_FALSE(v.components[1].is_estimated);
  EXPECT_EQ(v.components[1].factor, 0);
  EXPECT_EQ(v.notes, (std::vector<std::string>{
                         "reading, shared by day: its redundancy is 0: the values of the fit follow it"}));
  EXPECT_NEAR(v.components[0].dof, 24, 1e-9);
}

}  // namespace
