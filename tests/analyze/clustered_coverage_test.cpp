// Intervals of simulated fits hold as often as stated, for errors with and without dependence within groups.
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <slom/analyze/clustered.hpp>
#include <slom/measurements.hpp>
#include <slom/slom.hpp>

#include "support/clustered_designs.hpp"
#include "support/slow_with_sanitizers.hpp"

namespace {

using vec2 = mtk::vect<2>;
using vec3 = mtk::vect<3>;
using SE2 = mtk::trafo<mtk::SO2<>>;

struct Line {
  auto operator()(const auto& line, double x, double t) const { return line[0] + line[1] * x + line[2] * t; }
};

/// How often 95 % intervals hold, clustered and stated.
struct Coverage {
  int repetitions = 0;
  Eigen::Vector3d clustered = Eigen::Vector3d::Zero(), stated = Eigen::Vector3d::Zero();
};

struct Design {
  int groups = 20, per_group = 4, repetitions = 1000;
  double shared = 1;           ///< standard deviation of what the errors of a group have in common
  double autocorrelation = 0;  ///< of that between successive groups
  bool ordered = false;
};

/// Simulates a regression on a constant, a number of the group, and a number of the measurement. sigma is stated as if
/// all errors were independent.
Coverage simulate(const Design& design) {
  std::mt19937 engine(7);
  std::normal_distribution<double> normal;
  const double rho = design.autocorrelation;
  std::vector<double> x, t;
  double drift = 0;
  for (int g = 0; g < design.groups; ++g) {
    drift = rho * drift + std::sqrt(1 - rho * rho) * normal(engine);
    for (int i = 0; i < design.per_group; ++i) {
      x.push_back(drift);
      t.push_back(normal(engine));
    }
  }
  const vec3 truth(1, -2, 0.5);
  const slom::StandardDeviation sigma(std::sqrt(1 + design.shared * design.shared));
  Coverage result;
  for (; result.repetitions < design.repetitions; ++result.repetitions) {
    slom::Estimator est;
    est.setThreads(1);
    const auto line = est.insertRV(vec3(0, 0, 0));
    double common = normal(engine);
    for (int g = 0, k = 0; g < design.groups; ++g) {
      common = rho * common + std::sqrt(1 - rho * rho) * normal(engine);
      for (int i = 0; i < design.per_group; ++i, ++k) {
        const auto at = static_cast<std::size_t>(k);
        const double y =
            truth[0] + truth[1] * x[at] + truth[2] * t[at] + design.shared * common + normal(engine);
        est.insertMeasurement(Line(), line, x[at], t[at], slom::measured(y), sigma, slom::group(g));
      }
    }
    est.optimize({.most_parameters = 0});
    const slom::Clustered c = slom::clustered(est, {.ordered = design.ordered});
    const Eigen::Vector3d error = *line - truth, half = c.interval(line, 0.95),
                          stated = 1.959964 * est.standardDeviation(line);
    for (int k = 0; k < 3; ++k) {
      result.clustered[k] += std::abs(error[k]) <= half[k] ? 1 : 0;
      result.stated[k] += std::abs(error[k]) <= stated[k] ? 1 : 0;
    }
  }
  result.clustered /= design.repetitions;
  result.stated /= design.repetitions;
  return result;
}

class ClusteredCoverage : public ::testing::TestWithParam<int> {};

TEST_P(ClusteredCoverage, OfErrorsThatGroupsShare) {
  SLOM_SKIP_WITH_SANITIZERS();
  const Coverage coverage = simulate({.groups = GetParam()});
  EXPECT_GE(coverage.clustered.minCoeff(), 0.93) << coverage.clustered.transpose();
  EXPECT_LE(coverage.clustered.maxCoeff(), 0.97) << coverage.clustered.transpose();
  EXPECT_LT(coverage.stated.minCoeff(), 0.85) << coverage.stated.transpose();
}

INSTANTIATE_TEST_SUITE_P(Groups, ClusteredCoverage, ::testing::Values(10, 20, 50));

TEST(ClusteredCoverage, OfIndependentErrors) {
  SLOM_SKIP_WITH_SANITIZERS();
  const Coverage coverage = simulate({.shared = 0});
  EXPECT_GE(coverage.clustered.minCoeff(), 0.93) << coverage.clustered.transpose();
  EXPECT_LE(coverage.clustered.maxCoeff(), 0.97) << coverage.clustered.transpose();
  EXPECT_GE(coverage.stated.minCoeff(), 0.93) << coverage.stated.transpose();
  EXPECT_LE(coverage.stated.maxCoeff(), 0.97) << coverage.stated.transpose();
}

/// Few groups with correlated neighbours. Intervals are much nearer to 95 % than without the order. If they are not
/// near enough, a note says so.
TEST(ClusteredCoverage, OfErrorsThatSuccessiveGroupsShare) {
  SLOM_SKIP_WITH_SANITIZERS();
  struct Case {
    int groups, repetitions;
    double least_alone, least;  // of the constant, taken without and with their order
  };
  for (const Case& one : {Case{10, 1000, 0.83, 0.87}, Case{20, 1000, 0.80, 0.87}, Case{50, 500, 0.80, 0.915},
                          Case{200, 300, 0.80, 0.92}}) {
    const Design design{
        .groups = one.groups, .per_group = 2, .repetitions = one.repetitions, .autocorrelation = 0.6};
    const Coverage alone = simulate(design);
    EXPECT_LT(alone.clustered[0], one.least_alone) << one.groups;
    Design ordered = design;
    ordered.ordered = true;
    const Coverage coverage = simulate(ordered);
    EXPECT_GE(coverage.clustered.minCoeff(), one.least)
        << one.groups << ": " << coverage.clustered.transpose();
    EXPECT_LE(coverage.clustered.maxCoeff(), 0.985) << one.groups << ": " << coverage.clustered.transpose();
  }
}

TEST(ClusteredCoverage, OfIndependentGroupsInOrder) {
  SLOM_SKIP_WITH_SANITIZERS();
  for (const int groups : {10, 20, 50}) {
    const Coverage coverage = simulate({.groups = groups, .ordered = true});
    EXPECT_GE(coverage.clustered.minCoeff(), 0.93) << groups << ": " << coverage.clustered.transpose();
    EXPECT_LE(coverage.clustered.maxCoeff(), 0.985) << groups << ": " << coverage.clustered.transpose();
  }
}

/// A level whose errors are fractionally integrated noise of order d: their memory is longer than all blocks. If the
/// variance by blocks is seen to grow, it is extrapolated. One value with 128 groups does not always show the growth:
/// intervals hold in two thirds of all runs, and in half of them without the extrapolation.
TEST(ClusteredCoverage, OfErrorsWithALongMemory) {
  SLOM_SKIP_WITH_SANITIZERS();
  constexpr int groups = 128, memory = 3000, repetitions = 300;
  constexpr double d = 0.4;
  std::vector<double> weights{1};
  for (int k = 1; k < memory; ++k) weights.push_back(weights.back() * (k - 1 + d) / k);
  std::mt19937 engine(11);
  std::normal_distribution<double> normal;
  int in_order = 0, alone = 0;
  for (int run = 0; run < repetitions; ++run) {
    std::vector<double> shocks(memory + groups);
    for (double& shock : shocks) shock = normal(engine);
    slom::Estimator est;
    est.setThreads(1);
    const auto level = est.insertRV(0.0, "level");
    for (int g = 0; g < groups; ++g) {
      double error = 0;
      for (int k = 0; k < memory; ++k)
        error += weights[static_cast<std::size_t>(k)] * shocks[static_cast<std::size_t>(memory + g - k)];
      for (int i = 0; i < 2; ++i)
        est.insertMeasurement([](const auto& x) { return x; }, level,
                              slom::measured(error + 0.1 * normal(engine)), slom::group("image", g));
    }
    est.optimize({.most_parameters = 0});
    const double error = std::abs(double(*level));
    in_order += error <= slom::clustered(est, {.ordered = true}).interval(level, 0.95)[0] ? 1 : 0;
    alone += error <= slom::clustered(est).interval(level, 0.95)[0] ? 1 : 0;
  }
  EXPECT_LT(alone, 0.3 * repetitions);
  EXPECT_GE(in_order, 0.62 * repetitions);
}

/// Groups of different sizes: one much larger than all others together, and lognormal sizes. If the fit follows a group
/// closely, its residuals say little about its error, so cr2 is a third of the truth there.
TEST(ClusteredCoverage, HoldsWhereGroupsDifferInSize) {
  SLOM_SKIP_WITH_SANITIZERS();
  struct Sizes {
    const char* name;
    std::vector<int> of;
    double least;
  };
  std::vector<Sizes> all;
  for (const int groups : {20, 40}) {
    std::vector<int> sizes(static_cast<std::size_t>(groups), 3);
    sizes[0] = 10 * groups;
    all.push_back({"one large", sizes, 0.93});
  }
  std::mt19937 engine(3);
  std::normal_distribution<double> normal;
  std::vector<int> lognormal;
  for (int g = 0; g < 30; ++g) lognormal.push_back(2 + static_cast<int>(std::exp(2 + 1.2 * normal(engine))));
  all.push_back({"lognormal", lognormal, 0.92});
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const Sizes& sizes : all) {
    constexpr int repetitions = 300;
    int holds = 0, notes = 0;
    double squared_error = 0, variance = 0;
    for (int k = 0; k < repetitions; ++k) {
      slom::Estimator est;
      est.setThreads(1);
      const auto line = est.insertRV(vec2(0, 0), "line");
      for (std::size_t g = 0; g < sizes.of.size(); ++g) {
        const double common = 0.2 * normal(engine);
        for (int i = 0; i < sizes.of[g]; ++i) {
          const double x = uniform(engine) + 0.3 * static_cast<double>(g);
          est.insertMeasurement([](const auto& p, double at, double y) { return p[0] + p[1] * at - y; }, line,
                                x, 1 + 2 * x + common + 0.1 * normal(engine), slom::StandardDeviation(0.1),
                                slom::group(static_cast<int>(g)));
        }
      }
      est.optimize({.most_parameters = 0});
      const slom::Clustered c = slom::clustered(est);
      const double error = (*line)[1] - 2;
      holds += std::abs(error) <= c.interval(line, 0.95)[1] ? 1 : 0;
      squared_error += error * error;
      variance += std::pow(c.standardDeviation(line)[1], 2);
      notes +=
          c.report().find("one group (in brackets) determines most of a value") != std::string::npos ? 1 : 0;
    }
    EXPECT_GE(holds, sizes.least * repetitions) << sizes.name << sizes.of.size();
    EXPECT_GT(std::sqrt(variance / squared_error), 0.85) << sizes.name << sizes.of.size();
    if (sizes.name == std::string("one large")) {
      EXPECT_GT(notes, 0.9 * repetitions);
    }
  }
}

/// Returns the largest k with P(at most k - 1 of n hold) <= 1e-4, if each holds with probability 0.95.
int leastOf(int n) {
  double probability = std::pow(0.05, n), sum = probability;
  int k = 0;
  while (sum <= 1e-4) {
    probability *= 0.95 / 0.05 * (n - k) / (k + 1);
    sum += probability;
    ++k;
  }
  return k;
}

/// 5 to 50 groups, one way or two; equal, with 400 of one group against 3 of each other, and lognormal.
TEST(ClusteredCoverage, OfTheDefaultHoldsOverNumbersAndSizesOfGroups) {
  SLOM_SKIP_WITH_SANITIZERS();
  namespace clusters = slom::testing::clusters;
  using clusters::Sizes;
  constexpr int runs = 200;
  EXPECT_EQ(leastOf(runs), 177);
  for (const int ways : {1, 2}) {
    for (const Sizes sizes : {Sizes::equal, Sizes::one_large, Sizes::lognormal}) {
      for (const int groups : {5, 10, 20, 50}) {
        const clusters::Design design{ways, sizes, groups};
        std::mt19937_64 random(17);
        clusters::Tally tally, uncorrected;
        for (int run = 0; run < runs; ++run) {
          slom::Estimator est;
          est.setThreads(1);
          const auto p = clusters::simulate(est, design, random);
          est.optimize({.most_parameters = 0});
          tally.add(design,
                    slom::clustered(est, clusters::optionsOf(design, slom::ClusterCorrection::by_leverage)),
                    p);
          if (ways == 1 && sizes == Sizes::one_large && groups >= 20)
            uncorrected.add(
                design, slom::clustered(est, clusters::optionsOf(design, slom::ClusterCorrection::cr2)), p);
        }
        const std::size_t worst = tally.worst();
        const auto where = ::testing::Message() << ways << " ways, sizes " << static_cast<int>(sizes) << ", "
                                                << groups << " groups";
        EXPECT_GE(tally.holds[worst], leastOf(runs)) << where;
        EXPECT_GT(tally.printedOverTrue(worst), 0.8) << where;
        if (sizes == Sizes::one_large || groups < 10) {
          EXPECT_GT(tally.named, 0.95 * runs) << where;
        }
        if (uncorrected.runs > 0) {
          EXPECT_LT(uncorrected.holds[1], 0.7 * runs) << where << ", cr2";
        }
      }
    }
  }
}

}  // namespace
