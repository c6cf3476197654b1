// Claims of convergence: difficult starts and data, time limits, and steps that must not move fixed components.
#include <chrono>
#include <thread>

#include <gtest/gtest.h>

#include <slom/slom.hpp>

#include "support/algorithms.hpp"
#include "support/classics/problem.hpp"
#include "support/message_of.hpp"

namespace {

namespace classics = slom::testing::classics;
using slom::testing::allAlgorithms;
using slom::testing::messageOf;

struct Fit {
  slom::Summary summary;
  std::vector<double> x;
};

Fit fit(const classics::Problem& problem, const slom::Algorithm& algorithm) {
  slom::Estimator est;
  est.setThreads(1);
  est.changeAlgorithm(algorithm.clone().release());
  const auto x = est.insertRV(Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(
                                  problem.start.data(), static_cast<Eigen::Index>(problem.start.size()))),
                              "x");
  est.insertMeasurement(
      [&problem](const auto& v) {
        using T = std::decay_t<decltype(v[0] * 1.0)>;
        Eigen::Matrix<T, Eigen::Dynamic, 1> r(problem.residuals), values(v.size());
        for (Eigen::Index i = 0; i < v.size(); ++i) values[i] = v[i];
        classics::evaluate<T>(problem, values.data(), r.data());
        return r;
      },
      x);
  Fit result{est.optimize(), {}};
  result.x.assign((*x).begin(), (*x).end());
  return result;
}

TEST(Convergence, IsClaimedOnlyWhereTheGradientVanishes) {
  std::vector<classics::Problem> problems = classics::publishedStarts();
  for (std::uint64_t seed = 0; seed < 80; ++seed) {
    problems.push_back(classics::randomClassic(seed));
    problems.push_back(classics::randomCurve(seed));
  }
  int claims = 0;
  for (const auto& algorithm : allAlgorithms()) {
    int optima = 0;
    for (const classics::Problem& problem : problems) {
      Fit result;
      try {
        result = fit(problem, *algorithm);
      } catch (const slom::Error& error) {  // the start has no value
        EXPECT_TRUE(error.id() == "slom.not-finite" || error.id() == "slom.overflow") << error.what();
        continue;
      }
      claims += result.summary.converged;
      optima += result.summary.converged && classics::isOptimum(problem, result.summary.final_rss);
      std::string why;
      EXPECT_FALSE(result.summary.converged && classics::isFalse(problem, result.x, &why))
          << problem.name << " by " << algorithm->name() << ": " << result.summary.message << "; " << why;
    }
    EXPECT_GT(optima, 60) << algorithm->name();
  }
  EXPECT_GT(claims, 400);
}

/// Cases found by bench_honesty: unknowns that left the region in which residuals depend on them, and residuals that
/// are small differences of numbers near 1e9.
TEST(Convergence, IsNotClaimedFarOutByLevenbergMarquardt) {
  for (const std::uint64_t seed : {7547, 9358, 11222, 13570, 13730, 14030}) {
    const classics::Problem problem = classics::randomClassic(seed);
    for (const auto& algorithm : allAlgorithms()) {
      const Fit result = fit(problem, *algorithm);
      std::string why;
      EXPECT_FALSE(result.summary.converged && classics::isFalse(problem, result.x, &why))
          << problem.name << " " << seed << " by " << algorithm->name() << ": " << result.summary.message
          << "; " << why;
    }
  }
}

/// x in 1 / (1 + x^2) from 1e12: moving it changes no residual there, but from x = 1 on it does. In x - x it never
/// does.
TEST(Convergence, TellsAnUnknownThatHasRunAwayFromOneThatCancels) {
  for (const bool runs_away : {true, false}) {
    slom::Estimator est;
    est.changeAlgorithm(slom::LevenbergMarquardt());
    const auto x = est.insertRV(1e12, "x");
    const auto y = est.insertRV(1.0, "y");
    for (int i = 0; i < 4; ++i) {
      est.insertMeasurement(
          [runs_away](const auto& a, const auto& b, const double& t) {
            return (runs_away ? t / (1.0 + a * a) : t * ((a * 0.1) * 3.0 - a * 0.3) * 1e-20) + b;
          },
          x, y, double(i), slom::measured(5.0 + 0.1 * i));
    }
    const slom::Summary summary = est.optimize();
    EXPECT_EQ(summary.converged, !runs_away) << summary;
  }
}

/// Powell's badly scaled function, started where exp(-x1) is below all digits.
TEST(Convergence, IsNotWhereOneUnknownIsOutOfSight) {
  const auto start = [](slom::Estimator& est) {
    const auto x = est.insertRV(mtk::vect<2>(0, 100), "x");
    est.insertMeasurement(
        [](const auto& v) { return mtk::vector(1e4 * v[0] * v[1] - 1.0, exp(-v[0]) + exp(-v[1]) - 1.0001); },
        x);
    return x;
  };
  for (const auto& algorithm : allAlgorithms()) {
    slom::Estimator est;
    est.changeAlgorithm(algorithm->clone().release());
    const auto x = start(est);
    const slom::Summary summary = est.optimize();
    if (algorithm->name() != "Levenberg-Marquardt") {
      EXPECT_EQ(summary.stop_reason, slom::StopReason::rank_deficient) << summary;
      EXPECT_NE(summary.message.find("do not determine x.y"), std::string::npos) << summary.message;
      EXPECT_EQ((*x)[1], 100);
    } else {
      EXPECT_LT(summary.final_rss, 1.03e-8) << summary;
      EXPECT_NEAR(1e4 * (*x)[0] * (*x)[1], 1, 1e-6);
    }
  }
}

/// A derivative with the wrong sign predicts a decrease that no step achieves.
struct NegatedJacobian {
  double t, y;
  double operator()(const mtk::vect<2>& p) const { return p[0] * std::exp(p[1] * t) - y; }
  template <class J>
  void jacobian(const mtk::vect<2>& p, J& by_p) const {
    by_p(0, 0) = -std::exp(p[1] * t);
    by_p(0, 1) = -p[0] * t * std::exp(p[1] * t);
  }
};

TEST(Convergence, IsNotWhereDerivativesAreWrong) {
  for (const auto& algorithm : allAlgorithms()) {
    slom::Estimator est;
    est.changeAlgorithm(algorithm->clone().release());
    const auto p = est.insertRV(mtk::vect<2>(1, 0.1), "p");
    for (int i = 0; i < 10; ++i) est.insertMeasurement(NegatedJacobian{0.2 * i, 3 * std::exp(0.16 * i)}, p);
    const slom::Summary summary = est.optimize();
    EXPECT_FALSE(summary.converged) << summary;
    EXPECT_EQ(summary.stop_reason, slom::StopReason::no_progress);
    EXPECT_EQ(summary.message.rfind(
                  "no step makes the RSS smaller, although the linear model predicts a decrease by ", 0),
              0u)
        << summary.message;
  }
}

/// Two contradicting measurements must not hide the information of the others.
TEST(Convergence, IsJudgedInStandardDeviationsNotByTheWholeRss) {
  const auto rate = [](double apart, const slom::Algorithm& algorithm) {
    slom::Estimator est;
    est.changeAlgorithm(algorithm.clone().release());
    const auto p = est.insertRV(mtk::vect<2>(1, 0.1), "p");
    for (int i = 0; i < 20; ++i) {
      est.insertMeasurement(
          [](const auto& v, const double& t, const double& y) { return v[0] * exp(v[1] * t) - y; }, p,
          0.1 * i, 3 * std::exp(0.08 * i) + (i % 2 ? 0.01 : -0.01), slom::StandardDeviation(0.01));
    }
    const auto other = est.insertRV(0.0, "other");
    est.insertMeasurement([](const auto& v) { return v; }, other);
    if (apart > 0) est.insertMeasurement([](const auto& v, const double& z) { return v - z; }, other, apart);
    const slom::Summary summary = est.optimize();
    EXPECT_TRUE(summary.converged) << summary;
    return std::pair((*p)[1], est.standardDeviation(p)[1]);
  };
  for (const auto& algorithm : allAlgorithms()) {
    const auto [expected, deviation] = rate(0, *algorithm);
    for (const double apart : {1e3, 1e7, 1e8}) {
      EXPECT_NEAR(rate(apart, *algorithm).first, expected, 1e-5 * deviation)
          << algorithm->name() << ", " << apart;
    }
  }
}

TEST(Convergence, SumsThatOverflowAreNoFit) {
  slom::Estimator est;
  const auto x = est.insertRV(0.0, "x");
  est.insertMeasurement([](const auto& v) { return v - 1.0; }, x, slom::named("small"));
  est.insertMeasurement([](const auto& v) { return v + 1e155; }, x, slom::named("large"));
  EXPECT_EQ(messageOf([&] { est.optimize(); }),
            "[slom.overflow] measurement large #1 has a residual of 1e+155 standard deviations or a "
            "derivative of 1e+155 at x = "
            "(0), too large for sums of squares; check its data, its uncertainty and the start values");
  EXPECT_EQ(*x, 0);
}

/// Rosenbrock's function, each look at which takes 20 ms.
struct Slow {
  slom::Estimator est;
  slom::VarID<mtk::vect<2>> x = est.insertRV(mtk::vect<2>(-1.2, 1), "x");
  slom::Options options;
  Slow() {
    est.changeAlgorithm(slom::LevenbergMarquardt());
    est.insertMeasurement(
        [](const auto& v) {
          std::this_thread::sleep_for(std::chrono::milliseconds(20));
          return mtk::vector(10.0 * (v[1] - v[0] * v[0]), 1.0 - v[0]);
        },
        x);
  }
};

TEST(Limits, OfTimeEndsAFit) {
  Slow slow;
  slow.options.max_seconds = 0.05;
  const slom::Summary summary = slow.est.optimize(slow.options);
  EXPECT_EQ(summary.stop_reason, slom::StopReason::time_limit) << summary;
  EXPECT_EQ(summary.message, "time limit of 0.05 s reached");
  EXPECT_FALSE(summary.converged);
  EXPECT_LE(summary.final_rss, summary.initial_rss);
  EXPECT_EQ(summary.final_rss, slow.est.getRSS());
}

/// A residual whose derivative has the wrong sign, so that all steps are refused.
struct UphillOnly {
  double operator()(double x) const {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return std::exp(x);
  }
  void jacobian(double x, auto& J) const { J(0, 0) = -std::exp(x); }
};

TEST(Limits, OfTimeEndsAnIterationWhoseStepsAreAllRefused) {
  slom::Estimator est;
  est.changeAlgorithm(slom::LevenbergMarquardt());
  const auto x = est.insertRV(1.0, "x");
  est.insertMeasurement(UphillOnly(), x);
  const slom::Summary summary = est.optimize({.max_seconds = 0.05});
  EXPECT_EQ(summary.stop_reason, slom::StopReason::time_limit) << summary;
  EXPECT_EQ(summary.iterations, 0) << "within the first one";
  EXPECT_EQ(*x, 1) << "the last accepted values";
  EXPECT_LT(summary.seconds, 0.5);
}

TEST(Limits, ShouldStopEndsAFit) {
  Slow slow;
  int asked = 0;
  slow.options.should_stop = [&] { return ++asked > 3; };
  const slom::Summary summary = slow.est.optimize(slow.options);
  EXPECT_EQ(summary.stop_reason, slom::StopReason::interrupted);
  EXPECT_EQ(summary.message, "interrupted");
  EXPECT_FALSE(summary.converged);
  EXPECT_EQ(summary.final_rss, slow.est.getRSS());
}

TEST(Limits, AnObserverMayEndAFit) {
  Slow slow;
  int last = -1;
  slow.options.observer = [&](const slom::IterationRecord& record) {
    last = record.iteration;
    return record.iteration == 2 ? slom::FitControl::stop : slom::FitControl::go_on;
  };
  const slom::Summary summary = slow.est.optimize(slow.options);
  EXPECT_EQ(last, 2);
  EXPECT_EQ(summary.iterations, 2);
  EXPECT_EQ(summary.stop_reason, slom::StopReason::interrupted);
  EXPECT_EQ(summary.final_rss, slow.est.getRSS());
  EXPECT_LE(summary.final_rss, summary.initial_rss);
  slow.options.observer = [](const slom::IterationRecord&) { return slom::FitControl::stop; };
  EXPECT_EQ(slow.est.optimize(slow.options).iterations, 0) << "from the start";
  slow.options.observer = std::function<void(const slom::IterationRecord&)>();
  EXPECT_FALSE(slow.options.observer) << "an empty function is none";
}

/// Full Gauss-Newton steps on atan(x) from 1.5 alternate between both sides, farther and farther away.
TEST(Limits, LeaveTheBestValuesWhereStepsLeadUphill) {
  for (const bool by_observer : {false, true}) {
    slom::Estimator est;
    const auto x = est.insertRV(1.5, "x");
    est.insertMeasurement([](const auto& v) { return atan(v); }, x);
    slom::Options options;
    options.fall_back = false;
    if (by_observer) {
      options.observer = [](const slom::IterationRecord& record) {
        return record.iteration == 3 ? slom::FitControl::stop : slom::FitControl::go_on;
      };
    } else {
      options.max_iterations = 3;
    }
    const slom::Summary summary = est.optimize(options);
    EXPECT_EQ(summary.iterations, 3);
    EXPECT_FALSE(summary.converged);
    EXPECT_GT(summary.trace.back().rss, summary.initial_rss);
    EXPECT_EQ(summary.final_rss, summary.initial_rss);
    EXPECT_EQ(*x, 1.5);
    EXPECT_EQ(est.getRSS(), summary.final_rss);
  }
}

TEST(Limits, AreChecked) {
  slom::Estimator est;
  slom::Options options;
  options.max_seconds = -1;
  EXPECT_EQ(messageOf([&] { est.optimize(options); }),
            "[slom.bad-option] max_seconds is -1; pass a positive number");
  options.max_seconds = 0;
  EXPECT_EQ(messageOf([&] { est.optimize(options); }),
            "[slom.bad-option] max_seconds is 0; pass a positive number");
  options.max_seconds = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(messageOf([&] { est.optimize(options); }),
            "[slom.bad-option] max_seconds is nan; pass a positive number");
  options = {};
  options.deviation_tolerance = -1;
  EXPECT_EQ(
      messageOf([&] { est.optimize(options); }),
      "[slom.bad-option] deviation_tolerance is -1; pass 0 or more, such as 1e-8, or infinity for none");
  options = {};
  options.max_iterations = -7;
  EXPECT_EQ(messageOf([&] { est.optimize(options); }),
            "[slom.bad-option] max_iterations is -7; pass 0 or more, or Options::kByTheSize");
}

TEST(Fixed, ComponentsDoNotMoveByRounding) {
  slom::Estimator est;
  est.changeSolver(std::make_unique<slom::BlockQR>());
  const auto x = est.insertRV(mtk::vect<3>(1e6, 2, 3), "x");
  for (int i = 0; i < 9; ++i) {
    est.insertMeasurement(
        [](const auto& v, const double& t) { return 1e8 * (v[0] - 1e6) + v[1] * exp(v[2] * t) - 2.0 * t; }, x,
        0.3 * i);
  }
  est.fix(x, "x");
  est.optimize();
  EXPECT_EQ((*x)[0], 1e6);
}

TEST(Fixed, ValuesStayWithinTheirBoundToTheLastDigit) {
  int at_bound = 0;
  for (int k = 1; k <= 500; ++k) {
    const double upper = 1 + 0.7 * k / 13;
    slom::Estimator est;
    const auto x = est.insertRV(mtk::vect<2>(0.1 * upper, 1), "x");
    est.bound(x, "x", 0, upper);
    est.insertMeasurement([](const auto& v, const double& u) { return v[0] - 2 * u + 0.1 * v[1]; }, x, upper);
    est.insertMeasurement(
        [](const auto& v, const double& u) { return sqrt(u - v[0] + 1e-30) * 1e-3 + v[1] - 1.0; }, x, upper);
    ASSERT_NO_THROW(est.optimize()) << k;
    EXPECT_LE((*x)[0], upper) << k;
    at_bound += (*x)[0] == upper;
  }
  EXPECT_GT(at_bound, 100);
}

/// sqrt(limit - x) has a value at the limit, but no derivative.
TEST(Fixed, DerivativesThatEndAtABoundEndNoFitByAnException) {
  for (const auto& algorithm : allAlgorithms()) {
    for (const bool is_numeric : {false, true}) {
      slom::Estimator est;
      est.changeAlgorithm(algorithm->clone().release());
      const auto x = est.insertRV(0.5, "x");
      est.bound(x, -10, 2);
      const auto root = [](const auto& v) { return sqrt(2.0 - v); };
      if (is_numeric) {
        est.insertMeasurement(slom::numeric(root), x, slom::StandardDeviation(0.1));
      } else {
        est.insertMeasurement(root, x, slom::StandardDeviation(0.1));
      }
      est.insertMeasurement([](const auto& v) { return v - 2.5; }, x, slom::StandardDeviation(0.3));
      slom::Summary summary;
      ASSERT_NO_THROW(summary = est.optimize()) << algorithm->name();
      EXPECT_LE(*x, 2);
      EXPECT_NEAR(*x, 2, 1e-3) << algorithm->name() << summary;
      EXPECT_EQ(summary.final_rss, est.getRSS());
    }
  }
}

/// A start such as sin(pi) says nothing of how far its unknown may go.
TEST(Unseen, IsNoUnknownWhoseStartIsTiny) {
  for (const auto& algorithm : allAlgorithms()) {
    for (const double start : {0.0, 1e-300, 1e-30, 1.2246e-16, -1e-12}) {
      for (const double scale : {1e-9, 1e-6, 1e-3}) {
        slom::Estimator est;
        est.changeAlgorithm(algorithm->clone().release());
        const auto x = est.insertRV(Eigen::Vector3d(start, 0, scale), "x");
        for (int i = 0; i < 10; ++i) {
          const double u = std::sin(1.7 * i), z = 300 + 500 * u + 0.8 * std::cos(5.0 * i);
          est.insertMeasurement(
              [](const auto& v, double at, double measured) { return (v[0] + v[1] * at) * v[2] - measured; },
              x, u, z);
        }
        est.insertMeasurement([](const auto& v, double s) { return v[2] - s; }, x, scale,
                              slom::StandardDeviation(1e-3 * scale));
        const slom::Summary summary = est.optimize();
        EXPECT_TRUE(summary.converged) << algorithm->name() << start << " " << scale << summary;
        EXPECT_LT(summary.final_rss, 10) << algorithm->name() << start << " " << scale;
      }
    }
  }
}

/// Columns that are equal up to 1e-7. The normal equations lose their difference, but the data contain it.
TEST(Rank, IsFoundByTheCarefulSolverWhereTheNormalEquationsLoseIt) {
  const auto make = [](slom::Estimator& est) {
    const auto x = est.insertRV(mtk::vect<2>(0, 0), "x");
    for (int i = 0; i < 12; ++i) {
      const double a = 1 + 0.1 * i, b = a + 1e-7 * std::sin(i);
      est.insertMeasurement([](const auto& v, const double& p, const double& q,
                               const double& y) { return v[0] * p + v[1] * q - y; },
                            x, a, b, 2 * a + 3 * b + 0.01 * std::cos(3 * i), slom::StandardDeviation(0.01));
    }
    return x;
  };
  slom::Estimator est, oracle;
  const auto x = make(est), y = make(oracle);
  oracle.changeSolver(std::make_unique<slom::BlockQR>());
  const slom::Summary summary = est.optimize();
  EXPECT_TRUE(summary.converged) << summary;
  EXPECT_EQ(summary.solver.rfind("sparse QR", 0), 0u) << summary.solver;
  EXPECT_TRUE(oracle.optimize().converged);
  const Eigen::Vector2d deviation = oracle.standardDeviation(y);
  for (int c = 0; c < 2; ++c) {
    EXPECT_NEAR((*x)[c], (*y)[c], 1e-6 * deviation[c]);
    EXPECT_NEAR(est.standardDeviation(x)[c], deviation[c], 1e-6 * deviation[c]);
  }
}

TEST(Rank, BlockQRSolvesALinearProblemInFewIterations) {
  slom::Estimator est;
  est.changeSolver(std::make_unique<slom::BlockQR>());
  const auto x = est.insertRV(mtk::vect<3>(1e3, -1e3, 5), "x");
  for (int i = 0; i < 30; ++i) {
    const double t = 1000 + i;
    est.insertMeasurement(
        [](const auto& v, const double& s, const double& y) { return v[0] + v[1] * s + v[2] * s * s - y; }, x,
        t, 1 + 2 * t + 3e-3 * t * t + 0.01 * std::sin(7 * i), slom::StandardDeviation(0.01));
  }
  const slom::Summary summary = est.optimize();
  EXPECT_TRUE(summary.converged) << summary;
  EXPECT_LE(summary.iterations, 10) << summary;
}

}  // namespace
