// The three algorithms on classical problems, their stopping rules, and their behaviour at faults.
#include <cmath>
#include <initializer_list>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include <slom/slom.hpp>

#include "support/message_of.hpp"

namespace {

using slom::testing::messageOf;

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector4d;

/// More, Garbow and Hillstrom, "Testing unconstrained optimization software", 1981: number, start, known minimum of the
/// sum of squares.
struct Classic {
  const char* name;
  Eigen::VectorXd start;
  Eigen::VectorXd (*f)(const Eigen::VectorXd&);
  double minimum;
  bool singular;  ///< J loses rank at the start or at the solution: nothing for an undamped step
};

Eigen::VectorXd vec(std::initializer_list<double> x) {
  return Eigen::Map<const Eigen::VectorXd>(x.begin(), static_cast<Eigen::Index>(x.size()));
}

const Classic kClassics[] = {
    {"Rosenbrock (1)", vec({-1.2, 1}),
     [](const Eigen::VectorXd& x) {
       return vec({10 * (x[1] - x[0] * x[0]), 1 - x[0]});
     },
     0, false},
    {"Freudenstein and Roth (2)", vec({6, 5}),
     [](const Eigen::VectorXd& x) {
       return vec(
           {-13 + x[0] + ((5 - x[1]) * x[1] - 2) * x[1], -29 + x[0] + ((x[1] + 1) * x[1] - 14) * x[1]});
     },
     0, false},
    {"Beale (5)", vec({1, 1}),
     [](const Eigen::VectorXd& x) {
       return vec({1.5 - x[0] * (1 - x[1]), 2.25 - x[0] * (1 - std::pow(x[1], 2)),
                   2.625 - x[0] * (1 - std::pow(x[1], 3))});
     },
     0, true},
    {"Jennrich and Sampson (6)", vec({0.3, 0.4}),
     [](const Eigen::VectorXd& x) {
       Eigen::VectorXd r(10);
       for (int i = 1; i <= 10; ++i) r[i - 1] = 2 + 2 * i - (std::exp(i * x[0]) + std::exp(i * x[1]));
       return r;
     },
     124.362182355615, true},
    {"helical valley (7)", vec({-1, 0, 0}),
     [](const Eigen::VectorXd& x) {
       const double theta = std::atan(x[1] / x[0]) / (2 * M_PI) + (x[0] < 0 ? 0.5 : 0);
       return vec({10 * (x[2] - 10 * theta), 10 * (std::hypot(x[0], x[1]) - 1), x[2]});
     },
     0, false},
    {"Bard (8)", vec({1, 1, 1}),
     [](const Eigen::VectorXd& x) {
       static const double y[] = {0.14, 0.18, 0.22, 0.25, 0.29, 0.32, 0.35, 0.39,
                                  0.37, 0.58, 0.73, 0.96, 1.34, 2.10, 4.39};
       Eigen::VectorXd r(15);
       for (int i = 1; i <= 15; ++i) {
         const double u = i, v = 16 - i, w = std::min(u, v);
         r[i - 1] = y[i - 1] - (x[0] + u / (v * x[1] + w * x[2]));
       }
       return r;
     },
     8.21487730657897e-3, false},
    {"Powell singular (13)", vec({3, -1, 0, 1}),
     [](const Eigen::VectorXd& x) {
       return vec({x[0] + 10 * x[1], std::sqrt(5.0) * (x[2] - x[3]), std::pow(x[1] - 2 * x[2], 2),
                   std::sqrt(10.0) * std::pow(x[0] - x[3], 2)});
     },
     0, true},
    {"Kowalik and Osborne (15)", vec({0.25, 0.39, 0.415, 0.39}),
     [](const Eigen::VectorXd& x) {
       static const double y[] = {0.1957, 0.1947, 0.1735, 0.1600, 0.0844, 0.0627,
                                  0.0456, 0.0342, 0.0323, 0.0235, 0.0246};
       static const double u[] = {4, 2, 1, 0.5, 0.25, 0.167, 0.125, 0.1, 0.0833, 0.0714, 0.0625};
       Eigen::VectorXd r(11);
       for (int i = 0; i < 11; ++i)
         r[i] = y[i] - x[0] * (u[i] * u[i] + u[i] * x[1]) / (u[i] * u[i] + u[i] * x[2] + x[3]);
       return r;
     },
     3.07505603849238e-4, false},
    {"Brown and Dennis (16)", vec({25, 5, -5, -1}),
     [](const Eigen::VectorXd& x) {
       Eigen::VectorXd r(20);
       for (int i = 1; i <= 20; ++i) {
         const double t = i / 5.0;
         r[i - 1] = std::pow(x[0] + t * x[1] - std::exp(t), 2) +
                    std::pow(x[2] + x[3] * std::sin(t) - std::cos(t), 2);
       }
       return r;
     },
     85822.2016263563, false},
};

void expectSolved(const Classic& problem, const slom::Algorithm& algorithm) {
  slom::Estimator est;
  est.changeAlgorithm(algorithm.clone().release());
  const auto id = est.insertRV(problem.start);
  est.insertMeasurement(problem.f, id);
  slom::Options options;
  options.max_iterations = 500;
  const slom::Summary summary = est.optimize(options);
  const std::string what = std::string(problem.name) + " by " + algorithm.name() + ": " + summary.message;
  EXPECT_TRUE(summary.converged) << what;
  // The second minimum of Freudenstein and Roth is as good a result.
  const bool other = std::string(problem.name) == "Freudenstein and Roth (2)" &&
                     std::abs(summary.final_rss - 48.9842536792400) < 1e-9;
  EXPECT_TRUE(other || std::abs(summary.final_rss - problem.minimum) <= 1e-9 * problem.minimum + 1e-12)
      << what << " RSS " << summary.final_rss;
  EXPECT_EQ(summary.final_rss, est.getRSS());
  for (std::size_t i = 1; i < summary.trace.size(); ++i) {
    EXPECT_LE(summary.trace[i].rss, summary.trace[i - 1].rss * (1 + 1e-12)) << what << " iteration " << i;
  }
}

// Madsen, Nielsen and Tingleff 2004, section 3.1: f = (x + 1, x^2 / 2 + x - 1) is smallest at 0. There Gauss-Newton
// halves the error, and the sum of squares, 2, cannot show the last 8 digits of x.
template <class Algorithm>
void expectLastDigits(const Algorithm& algorithm) {
  slom::Estimator est;
  const auto x = est.insertRV(1.0, "x");
  est.insertMeasurement([](const auto& v) { return std::array{v + 1.0, 0.5 * v * v + v - 1.0}; }, x);
  est.changeAlgorithm(algorithm);
  slom::Options options;
  options.gradient_tolerance = options.step_tolerance = 1e-15;
  options.decrease_tolerance = 0;
  const slom::Summary summary = est.optimize(options);
  EXPECT_TRUE(summary.converged) << summary;
  EXPECT_NEAR(*x, 0, 1e-14) << summary;
  EXPECT_NEAR(summary.final_rss, 2, 1e-14) << summary;
}

TEST(Algorithms, FindTheDigitsThatTheRssDoesNotShow) {
  expectLastDigits(slom::LevenbergMarquardt());
  expectLastDigits(slom::DogLeg());
}

TEST(Algorithms, LevenbergMarquardtSolvesTheClassics) {
  for (const Classic& problem : kClassics) expectSolved(problem, slom::LevenbergMarquardt());
}

TEST(Algorithms, DogLegSolvesTheClassics) {
  for (const Classic& problem : kClassics) {
    if (!problem.singular) expectSolved(problem, slom::DogLeg());
  }
}

TEST(Algorithms, GaussNewtonFallsBackWhereItMustAndSolvesThem) {
  for (const Classic& problem : kClassics) {
    if (!problem.singular) expectSolved(problem, slom::GaussNewton());
  }
}

TEST(GaussNewton, FitsALineInOneStepAndStops) {
  slom::Estimator est;
  const auto line = est.insertRV(Vector2d(100, -7), "line");
  for (int i = 0; i < 10; ++i) {
    est.insertMeasurement([](const Vector2d& l, double x, double y) { return l[0] + l[1] * x - y; }, line,
                          0.1 * i, 2 + 0.3 * i + (i % 2 ? 0.1 : -0.1));
  }
  const slom::Summary summary = est.optimize();
  EXPECT_TRUE(summary.converged);
  EXPECT_LE(summary.iterations, 3)
      << "the first, one for what differences leave of it, and one that finds nothing more";
  EXPECT_EQ(summary.measurements, 10);
  EXPECT_EQ(summary.unknowns, 2);
  EXPECT_EQ(summary.redundancy, 8);
  EXPECT_EQ(summary.variables, 1);
  EXPECT_EQ(summary.trace.front().iteration, 0);
  EXPECT_EQ(static_cast<int>(summary.trace.size()), summary.iterations + 1);
}

TEST(GaussNewton, ReportsTheStepThatWasTakenBack) {
  slom::Estimator est;
  const auto x = est.insertRV(3.0);
  est.insertMeasurement([](double v) { return std::atan(v); }, x);  // Newton's classical divergence
  const slom::Summary summary = est.optimize();
  EXPECT_TRUE(summary.converged);
  EXPECT_NEAR(*x, 0, 1e-9);
  EXPECT_EQ(summary.trace[1].algorithm, "Levenberg-Marquardt");
  EXPECT_EQ(summary.algorithm, "Gauss-Newton") << "it returns";
  ASSERT_EQ(summary.warnings.size(), 1u);
  EXPECT_EQ(summary.warnings[0],
            "iteration 1: the Gauss-Newton step made the RSS grow; the step was taken back, and "
            "Levenberg-Marquardt continued from there");
}

TEST(GaussNewton, OptimizeStepMayLeadUphillAsPublished) {
  slom::Estimator est;
  const auto x = est.insertRV(3.0);
  est.insertMeasurement([](double v) { return std::atan(v); }, x);
  const double before = est.getRSS();
  const double gain = est.optimizeStep();
  EXPECT_LT(gain, 0);
  EXPECT_NEAR(gain, (before - est.getRSS()) / before, 1e-14);
  EXPECT_NEAR(*x, 3 - std::atan(3.0) * 10, 1e-5);
}

TEST(GaussNewton, WithoutFallBackItIsPlain) {
  slom::Estimator est;
  est.insertMeasurement([](double v) { return std::atan(v); }, est.insertRV(1.5));
  slom::Options options;
  options.fall_back = false;
  options.max_iterations = 3;
  const slom::Summary summary = est.optimize(options);
  EXPECT_FALSE(summary.converged);
  EXPECT_EQ(summary.stop_reason, slom::StopReason::max_iterations);
  EXPECT_EQ(summary.message, "iteration limit of 3 reached");
  EXPECT_GT(summary.trace.back().rss, summary.initial_rss);
  EXPECT_EQ(summary.final_rss, summary.initial_rss);  // the best that it has seen
}

/// Two points on a line, only their distance measured.
struct Floating {
  slom::Estimator est;
  slom::VarID<double> a = est.insertRV(1.0, "a"), b = est.insertRV(3.0, "b");
  Floating() {
    est.insertMeasurement([](double x, double y) { return y - x - 1; }, a, b);
  }
};

TEST(RankDeficiency, StopsGaussNewtonWithNamesAndNothingLost) {
  const std::string expected =
      "[slom.rank-deficient] the measurements do not determine a: given the other unknowns, less than 1e-08 "
      "of its column of the Jacobian remains, so it can move, alone or with others, without changing any "
      "residual; add measurements or a prior, "
      "fix a variable with fix(id) or a part of it with fix(id, \"path\"), or use LevenbergMarquardt to get one of the many solutions, or BlockQR, which "
      "needs 1e-12";
  const std::string expected_b = [&] {
    std::string t = expected;
    t.replace(t.find("determine a"), 11, "determine b");
    return t;
  }();
  Floating f;
  const slom::Summary summary = f.est.optimize();
  EXPECT_FALSE(summary.converged);
  EXPECT_EQ(summary.stop_reason, slom::StopReason::rank_deficient);
  EXPECT_TRUE(summary.message == expected || summary.message == expected_b) << summary.message;
  EXPECT_EQ(*f.a, 1);
  EXPECT_EQ(*f.b, 3);
  try {
    f.est.optimizeStep();
    FAIL();
  } catch (const mtk::Error& e) {
    EXPECT_EQ(e.what(), summary.message);
    EXPECT_EQ(e.id(), "slom.rank-deficient");
  }
  EXPECT_EQ(*f.a, 1);
  EXPECT_THROW(f.est.standardDeviation(f.a), mtk::Error);
  f.est.changeAlgorithm(slom::DogLeg());
  EXPECT_EQ(f.est.optimize().stop_reason, slom::StopReason::rank_deficient);
  f.est.optimizeRV(f.a, false);  // the remedy
  EXPECT_TRUE(f.est.optimize().converged);
  EXPECT_NEAR(*f.b, 2, 1e-9);
}

TEST(RankDeficiency, LevenbergMarquardtGoesOn) {
  Floating f;
  const auto unseen = f.est.insertRV(Vector3d(1, 2, 3), "unseen");
  f.est.changeAlgorithm(new SLOM::LevenbergMarquardt());
  const slom::Summary summary = f.est.optimize();
  EXPECT_TRUE(summary.converged) << summary.message;
  EXPECT_NEAR(*f.b - *f.a, 1, 1e-6);
  EXPECT_NEAR(*f.b + *f.a, 4, 1e-6) << "the shortest way there moves both alike";
  EXPECT_EQ(*unseen, Vector3d(1, 2, 3));
}

/// x cancels up to rounding: 0.1 * 3 - 0.3 = 5.6e-17.
TEST(RankDeficiency, OfAComponentWhoseDerivativeIsRounding) {
  const auto make = [](slom::Estimator& est) {
    const auto x = est.insertRV(2.0, "x");
    const auto y = est.insertRV(1.0, "y");
    for (int i = 0; i < 4; ++i) {
      const auto f = [](const auto& a, const auto& b, const double& t) {
        return (a * 0.1 * 3.0 - a * 0.3) * t + b;
      };
      est.insertMeasurement(f, x, y, double(i), slom::measured(5.0 + (i == 2 ? 0.1 : 0.0)));
    }
    return std::pair(x, y);
  };
  for (const bool dog_leg : {false, true}) {
    slom::Estimator est;
    const auto [x, y] = make(est);
    if (dog_leg) est.changeAlgorithm(slom::DogLeg());
    const slom::Summary summary = est.optimize();
    EXPECT_EQ(summary.stop_reason, slom::StopReason::rank_deficient) << summary;
    EXPECT_NE(summary.message.find("x"), std::string::npos) << summary.message;
    EXPECT_EQ(*x, 2.0);
    EXPECT_EQ(*y, 1.0);
  }
  slom::Estimator est;
  est.changeAlgorithm(slom::LevenbergMarquardt());
  const auto [x, y] = make(est);
  const slom::Summary summary = est.optimize();
  EXPECT_TRUE(summary.converged) << summary;
  EXPECT_EQ(*x, 2.0);
  EXPECT_NEAR(*y, 5.025, 1e-9);
}

/// That no residual changes with a shift of all is certain, whatever part of a column solvers ask for.
TEST(RankDeficiency, OfAFreeGaugeNeedsNoLimit) {
  slom::Estimator est;
  std::vector<slom::VarID<mtk::vect<2>>> points;
  for (int i = 0; i < 3; ++i)
    points.push_back(est.insertRV(mtk::vect<2>(i, 0.1 * i), "point " + std::to_string(i)));
  for (int i = 0; i + 1 < 3; ++i) {
    est.insertMeasurement([](const auto& a, const auto& b) { return b - a; }, points[std::size_t(i)],
                          points[std::size_t(i) + 1], slom::measured(mtk::vect<2>(1, 0)));
  }
  const slom::Summary summary = est.optimize();
  EXPECT_EQ(summary.stop_reason, slom::StopReason::rank_deficient);
  const std::string unknown = summary.message.substr(0, summary.message.find(": "));
  EXPECT_EQ(unknown.substr(0, unknown.size() - 3),
            "[slom.rank-deficient] the measurements do not determine point ");
  EXPECT_EQ(
      summary.message.substr(unknown.size()),
      ": it can move, alone or with others, without changing any residual; add measurements or a prior, "
      "fix a variable with fix(id) or a part of it with fix(id, \"path\"), or use LevenbergMarquardt to get one of the many solutions");
}

/// A power with a negative base has no derivative by its exponent. A fixed exponent needs none.
TEST(FixedComponents, NeedNoDerivative) {
  slom::Estimator est;
  const auto p = est.insertRV(mtk::vect<2>(1.5, 3), "p");
  for (int i = 1; i < 4; ++i) {
    est.insertMeasurement([](const auto& v, const double& t) { return pow(-v[0] * t, v[1]) + 8 * t * t * t; },
                          p, double(i));
  }
  EXPECT_EQ(messageOf([&] { est.optimize(); }).substr(0, 18), "[slom.not-finite] ");
  est.fix(p, "y");
  const slom::Summary summary = est.optimize();
  EXPECT_TRUE(summary.converged) << summary;
  EXPECT_NEAR((*p)[0], 2, 1e-9);
}

TEST(RankDeficiency, OfAnUnmeasuredVariableIsAWarningAndAnError) {
  const std::string sentence =
      "no measurement depends on variable bias, so nothing determines it; add measurements or fix "
      "it with fix(id)";
  slom::Estimator est;
  const auto x = est.insertRV(1.0), bias = est.insertRV(5.0, "bias");
  est.insertMeasurement([](double v) { return v; }, x);
  EXPECT_EQ(est.warnings(), std::vector<std::string>{sentence});
  const slom::Summary summary = est.optimize();
  EXPECT_EQ(summary.stop_reason, slom::StopReason::rank_deficient);
  EXPECT_EQ(summary.message, "[slom.unmeasured-variable] " + sentence);
  EXPECT_EQ(summary.warnings, std::vector<std::string>{sentence});
  EXPECT_EQ(*x, 1);
  est.optimizeRV(bias, false);
  EXPECT_TRUE(est.warnings().empty());
  EXPECT_TRUE(est.optimize().converged);
  EXPECT_EQ(*bias, 5);
}

TEST(NotFinite, AtTheStartNamesMeasurementAndValues) {
  slom::Estimator est;
  const auto a = est.insertRV(2.0, "a"), b = est.insertRV(-1.0, "b");
  est.insertMeasurement([](double x) { return x; }, a);
  est.insertMeasurement([](double x, double y) { return std::log(y) + x; }, a, b);
  for (int i = 0; i < 2; ++i) {
    try {
      i == 0 ? static_cast<void>(est.optimize()) : static_cast<void>(est.optimizeStep());
      FAIL();
    } catch (const mtk::Error& e) {
      EXPECT_STREQ(
          e.what(),
          "[slom.not-finite] the residual of measurement lambda-2 #1 is not finite at a = (2), b = (-1); "
          "check its data, the function where it divides, takes roots or logarithms or leaves an entry "
          "of its result unset, and the start values");
    }
    EXPECT_EQ(*a, 2);
  }
  est.reinitRV(b, 1.0);
  EXPECT_TRUE(est.optimize().converged);
}

TEST(NotFinite, AfterAStepIsTakenBack) {
  // sqrt has no values below zero, and the Gauss-Newton step overshoots to there.
  slom::Estimator est;
  const auto x = est.insertRV(1.0);
  est.insertMeasurement([](double v) { return std::sqrt(v) - 0.1; }, x);
  try {
    est.optimizeStep();
    FAIL();
  } catch (const mtk::Error& e) {
    EXPECT_STREQ(
        e.what(),
        "[slom.not-finite] the step of Gauss-Newton led to values at which a residual is not finite, and "
        "was taken back; start nearer to the solution, or use LevenbergMarquardt");
  }
  EXPECT_EQ(*x, 1);
  const slom::Summary summary = est.optimize();
  EXPECT_TRUE(summary.converged) << summary.message;
  EXPECT_NEAR(*x, 0.01, 1e-9);
  slom::Options plain;
  plain.fall_back = false;
  est.reinitRV(x, 1.0);
  EXPECT_EQ(est.optimize(plain).stop_reason, slom::StopReason::not_finite);
  EXPECT_EQ(*x, 1);
}

TEST(Stopping, ReasonsAreToldApart) {
  const auto fit = [](double start, double target, slom::Options options) {
    slom::Estimator est;
    const auto x = est.insertRV(start);
    est.insertMeasurement([](double v, double t) { return std::exp(v) - t; }, x, target);
    est.insertMeasurement([](double v, double t) { return std::exp(-v) - t; }, x, 0.7);
    return est.optimize(options);
  };
  slom::Options only_gradient, only_decrease, only_step;
  only_gradient.decrease_tolerance = only_gradient.step_tolerance = 0;
  only_gradient.gradient_tolerance = 1e-6;
  only_decrease.gradient_tolerance = only_decrease.step_tolerance = 0;
  only_step.gradient_tolerance = only_step.decrease_tolerance = 0;
  only_step.step_tolerance = 1e-5;
  EXPECT_EQ(fit(1, 2, only_gradient).stop_reason, slom::StopReason::gradient);
  EXPECT_EQ(fit(1, 2, only_decrease).stop_reason, slom::StopReason::decrease);
  EXPECT_EQ(fit(1, 2, only_step).stop_reason, slom::StopReason::step);
  slom::Options none;
  none.max_iterations = 0;
  EXPECT_EQ(fit(1, 2, none).stop_reason, slom::StopReason::max_iterations);
  EXPECT_FALSE(fit(1, 2, none).converged);
}

TEST(Stopping, WithNothingToDo) {
  slom::Estimator empty;
  const slom::Summary summary = empty.optimize();
  EXPECT_TRUE(summary.converged);
  EXPECT_EQ(summary.stop_reason, slom::StopReason::nothing_to_do);
  EXPECT_EQ(empty.optimizeStep(), 0);
  EXPECT_EQ(empty.getRSS(), 0);
  EXPECT_EQ(empty.getRMS(), 0);
  slom::Estimator fixed;
  fixed.insertMeasurement([](double v) { return v; }, fixed.insertRV(3.0, false));
  EXPECT_EQ(fixed.optimize().stop_reason, slom::StopReason::nothing_to_do);
  EXPECT_EQ(fixed.optimize().final_rss, 9);
}

TEST(Stopping, ExactDataThatAreStartedAtTheSolutionConverge) {
  std::mt19937 rng(std::random_device{}());
  std::normal_distribution<double> normal;
  for (int round = 0; round < 100; ++round) {
    const double a = normal(rng), b = normal(rng), scale = std::pow(10.0, round % 13 - 6);
    for (const slom::Sigma sigma : {slom::Sigma::known, slom::Sigma::estimated}) {
      slom::Estimator est;
      est.setSigma(sigma);
      const auto x = est.insertRV(a * scale, "a"), y = est.insertRV(b, "b");
      for (int i = 0; i < 10; ++i) {
        const double t = 0.2 * i;
        est.insertMeasurement([](const auto& x, const auto& y, double t, double z) { return x * t + y - z; },
                              x, y, t, a * scale * t + b);
      }
      for (int again = 0; again < 3; ++again) {
        const slom::Summary summary = est.optimize();
        EXPECT_TRUE(summary.converged) << "a = " << a * scale << ", b = " << b << "\n" << summary;
      }
    }
  }
}

TEST(SingularStarts, AreLeftIfAStepOfOtherUnknownsDeterminesAll) {
  const auto fit = [](const std::vector<double>& start, const std::vector<double>& truth, const auto& curve) {
    slom::Estimator est;
    std::vector<slom::VarID<double>> p;
    for (const double x : start) p.push_back(est.insertRV(x));
    for (int i = 0; i < 25; ++i) {
      const double t = 0.1 + 0.15 * i, y = curve(t, truth[0], truth[1], truth[2], truth[3]);
      est.insertMeasurement([curve](const auto& a, const auto& b, const auto& c, const auto& d, double at,
                                    double z) { return curve(at, a, b, c, d) - z; },
                            p[0], p[1], p[2], p[3], t, y);
    }
    const slom::Summary summary = est.optimize();
    EXPECT_TRUE(summary.converged) << summary;
    for (std::size_t k = 0; k < p.size(); ++k) EXPECT_NEAR(*p[k], truth[k], 1e-6) << summary;
  };
  fit({0, 0, 1, 1}, {0.5, 2, 0.7, 1},
      [](double t, const auto& a, const auto& b, const auto& c, const auto& d) {
        using std::exp;
        return a + b * exp(-c * t) + (d - 1.0) * t * t;
      });
  fit({1, 1, 1, 1}, {0.2, 3.2, 1.2, 1.7},
      [](double t, const auto& low, const auto& high, const auto& middle, const auto& slope) {
        using std::pow;
        return low + (high - low) / (1.0 + pow(t / middle, -slope));
      });
}

TEST(Stopping, WithoutMeasurementsIsNotConverged) {
  for (slom::Algorithm* algorithm : std::initializer_list<slom::Algorithm*>{
           new slom::GaussNewton, new slom::LevenbergMarquardt, new slom::DogLeg}) {
    slom::Estimator est;
    est.changeAlgorithm(algorithm);
    const auto x = est.insertRV(3.0, "x");
    const slom::Summary summary = est.optimize();
    EXPECT_FALSE(summary.converged) << summary;
    EXPECT_NE(summary.message.find("no measurement depends on variable x"), std::string::npos) << summary;
    EXPECT_EQ(*x, 3.0);
  }
}

TEST(Stopping, OnAPerfectFitWithoutNoise) {
  for (const bool scaled : {false, true}) {
    slom::Estimator est;
    const auto x = est.insertRV(mtk::trafo<mtk::SO3<>>());
    for (int i = 0; i < 4; ++i) {
      est.insertMeasurement(
          [](const mtk::trafo<mtk::SO3<>>& T, const mtk::vect<3>& p, const mtk::vect<3>& z) {
            return T * p - z;
          },
          x, mtk::vect<3>(i == 1, i == 2, i == 3),
          mtk::trafo<mtk::SO3<>>(mtk::SO3<>::exp(mtk::vect<3>(0.5, 1, 0.2)), mtk::vect<3>(1, 2, 3)) *
              mtk::vect<3>(i == 1, i == 2, i == 3),
          slom::StandardDeviation(scaled ? 1e-3 : 1.0));
    }
    const slom::Summary summary = est.optimize();
    EXPECT_TRUE(summary.converged) << summary.message;
    EXPECT_LT(summary.final_rss, 1e-18);
    EXPECT_LT(summary.iterations, 12);
    EXPECT_TRUE(summary.warnings.empty()) << summary.warnings[0];
  }
}

TEST(BadOptions, AreNamed) {
  EXPECT_EQ(messageOf([] { slom::LevenbergMarquardt(-1); }),
            "[slom.bad-option] the initial damping of LevenbergMarquardt is -1; pass a positive number");
  EXPECT_EQ(
      messageOf([] { slom::LevenbergMarquardt(1e-4, 2); }),
      "[slom.bad-option] the memory of LevenbergMarquardt is 2; pass a number from 0 (scales of the present "
      "linearisation) to 1 (the largest so far)");
  EXPECT_EQ(
      messageOf([] { slom::DogLeg(-2); }),
      "[slom.bad-option] the initial radius of DogLeg is -2; pass a positive number, or 0 for the length of the "
      "first Gauss-Newton step");
  EXPECT_EQ(
      messageOf([] { slom::Estimator().changeAlgorithm(nullptr); }),
      "[slom.no-algorithm] changeAlgorithm got a null pointer; pass a new GaussNewton, LevenbergMarquardt or DogLeg");
  EXPECT_EQ(messageOf([] { slom::Estimator().changeSolver(nullptr); }),
            "[slom.no-solver] changeSolver got a null pointer; pass a BlockSolver, BlockQR or DenseQR");
  EXPECT_EQ(
      messageOf([] { slom::Estimator().setThreads(-1); }),
      "[slom.bad-option] the number of threads is -1; pass a positive number, or 0 for as many as the machine has");
}

}  // namespace
