// Variance components of simulated fits: unbiased, and within their intervals as often as these say.
#include <cmath>
#include <random>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <slom/analyze/variance_components.hpp>
#include <slom/measurements.hpp>
#include <slom/slom.hpp>

namespace {

using SE2 = mtk::trafo<mtk::SO2<>>;
using vec2 = mtk::vect<2>;

struct Straight {
  auto operator()(const auto& line, double t) const { return line[0] + line[1] * t; }
};

struct LineSimulation {
  std::vector<double> sigma;  // by kind, over what is stated
  double shared = -1;         // of the first kind, by group; negative: there is none
  int per_kind = 20, groups = 5, repetitions = 1000;
};

struct Tally {
  Eigen::ArrayXd mean, square, by_deviation, by_interval;
};

/// A line measured by several instruments.
Tally simulateLine(const LineSimulation& wanted) {
  std::mt19937 engine(5);
  std::normal_distribution<double> normal;
  const char* const names[] = {"a", "b", "c"};
  std::vector<double> truth = wanted.sigma;
  if (wanted.shared >= 0) truth.push_back(wanted.shared);
  const auto n = static_cast<Eigen::Index>(truth.size());
  Tally tally{Eigen::ArrayXd::Zero(n), Eigen::ArrayXd::Zero(n), Eigen::ArrayXd::Zero(n),
              Eigen::ArrayXd::Zero(n)};
  slom::VarianceOptions options;
  if (wanted.shared >= 0) options.shared.push_back({"a", "set"});
  for (int repetition = 0; repetition < wanted.repetitions; ++repetition) {
    slom::Estimator est;
    est.setThreads(1);
    const auto line = est.insertRV(vec2(0, 0), "line");
    for (std::size_t k = 0; k < wanted.sigma.size(); ++k) {
      double common = 0;
      for (int i = 0; i < wanted.per_kind; ++i) {
        const double stated = 0.1 * (1 + double(k)), t = 0.1 * i;
        if (i % (wanted.per_kind / wanted.groups) == 0)
          common = k == 0 ? std::max(0.0, wanted.shared) * normal(engine) : 0;
        est.insertMeasurement(
            Straight(), line, t,
            slom::measured(1 + 2 * t + stated * (wanted.sigma[k] * normal(engine) + common)),
            slom::StandardDeviation(stated), slom::named(names[k]),
            slom::group("set", i / (wanted.per_kind / wanted.groups)));
      }
    }
    est.optimize({.most_parameters = 0});
    const slom::VarianceComponents v = slom::varianceComponents(est, options);
    for (Eigen::Index k = 0; k < n; ++k) {
      const slom::VarianceComponent& own = v.components[static_cast<std::size_t>(k)];
      const double true_factor = truth[static_cast<std::size_t>(k)], theta = own.factor * own.factor;
      tally.mean[k] += theta / (true_factor * true_factor);
      tally.square[k] += std::pow(theta / (true_factor * true_factor), 2);
      tally.by_deviation[k] +=
          std::abs(own.factor - true_factor) <= 1.959964 * own.standard_deviation ? 1 : 0;
      const auto [lower, upper] = own.interval();
      tally.by_interval[k] += lower <= true_factor && true_factor <= upper ? 1 : 0;
    }
  }
  const double count = wanted.repetitions;
  tally.mean /= count;
  tally.square = ((tally.square / count - tally.mean.square()) / count).sqrt();
  tally.by_deviation /= count;
  tally.by_interval /= count;
  return tally;
}

/// Expects unbiased factors. Intervals by chi-square hold in 93 to 97 % of the cases. So do intervals of two standard
/// deviations if there are enough residuals for the factor to be nearly normal.
void expectHolds(const Tally& tally, bool is_nearly_normal) {
  for (Eigen::Index k = 0; k < tally.mean.size(); ++k) {
    EXPECT_NEAR(tally.mean[k], 1, 3 * tally.square[k]) << k;
    EXPECT_GE(tally.by_interval[k], 0.93) << k;
    EXPECT_LE(tally.by_interval[k], 0.97) << k;
    if (!is_nearly_normal) continue;
    EXPECT_GE(tally.by_deviation[k], 0.93) << k;
    EXPECT_LE(tally.by_deviation[k], 0.97) << k;
  }
}

TEST(VarianceComponentsSimulation, OfTwoKinds) {
  expectHolds(simulateLine({.sigma = {2, 0.5}}), false);
  expectHolds(simulateLine({.sigma = {2, 0.5}, .per_kind = 60}), true);
}

TEST(VarianceComponentsSimulation, OfThreeKinds) {
  expectHolds(simulateLine({.sigma = {1, 5, 0.3}}), false);
  expectHolds(simulateLine({.sigma = {1, 5, 0.3}, .per_kind = 60}), true);
}

TEST(VarianceComponentsSimulation, OfASharedError) {
  expectHolds(simulateLine({.sigma = {1, 1}, .shared = 2, .per_kind = 60, .groups = 20}), false);
}

}  // namespace
