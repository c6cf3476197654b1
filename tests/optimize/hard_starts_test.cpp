// Starts far from any solution: curves whose derivatives overflow, saddles, plateaus, and places where a residual has
// no derivative. No fit throws, and no fit claims a minimum that it has not reached.
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include <mtk/testing/random.hpp>
#include <slom/measurements.hpp>
#include <slom/slom.hpp>

#include "support/algorithms.hpp"
#include "support/message_of.hpp"

namespace {

using mtk::testing::Random;
using slom::testing::allAlgorithms;
using slom::testing::messageOf;

/// 1 + 2 / (1 + exp(-1.5 (x - 5))) with noise of 0.02; the sum of squares is 30.45 at the optimum.
slom::VarID<Eigen::Vector4d> insertSigmoid(slom::Estimator& est, const Eigen::Vector4d& start) {
  const auto p = est.insertRV(start, "p");
  Random noise(11);
  for (int i = 0; i < 40; ++i) {
    const double x = 0.25 * i, y = 1 + 2 / (1 + std::exp(-1.5 * (x - 5))) + 0.02 * noise.normal();
    est.insertMeasurement(
        [](const auto& v, double at, double z) {
          using std::exp;
          return v[0] + v[1] / (1.0 + exp(-v[2] * (at - v[3]))) - z;
        },
        p, x, y, slom::StandardDeviation(0.02));
  }
  return p;
}

Eigen::Vector4d wideStart(Random& random) {
  return {random.uniform(-10, 10), random.uniform(-10, 10), random.uniform(-5, 5), random.uniform(-10, 20)};
}

TEST(HardStarts, NoFitOfASigmoidThrowsOrRisesOrClaimsAPlateau) {
  constexpr int fits = 60;
  for (const auto& algorithm : allAlgorithms()) {
    for (const bool has_bounds : {false, true}) {
      Random random(3);
      int optima = 0;
      for (int k = 0; k < fits; ++k) {
        slom::Estimator est;
        est.setThreads(1);
        est.changeAlgorithm(algorithm->clone().release());
        const auto p = insertSigmoid(est, wideStart(random));
        for (const char* component : {"0", "1", "2", "3"}) {
          if (has_bounds) est.bound(p, component, -1000, 1000);
        }
        const double before = est.getRSS();
        slom::Summary summary;
        ASSERT_NO_THROW(summary = est.optimize()) << algorithm->name() << " " << k;
        EXPECT_LE(est.getRSS(), before);
        EXPECT_NEAR(est.getRSS(), summary.final_rss, 1e-12 * summary.final_rss);
        // An algorithm with damping may end at a start that leaves the directions free, too.
        if (summary.converged && algorithm->name() == "Gauss-Newton") {
          EXPECT_EQ(summary.free_directions, 0) << summary;
        }
        optima += summary.converged && summary.final_rss < 100;
      }
      EXPECT_GT(optima, fits / 5) << algorithm->name();
    }
  }
}

TEST(HardStarts, OnlineFitsOfASigmoidDoNotThrow) {
  Random random(5);
  for (int k = 0; k < 40; ++k) {
    slom::Estimator est;
    est.setThreads(1);
    insertSigmoid(est, wideStart(random));
    const double before = est.getRSS();
    ASSERT_NO_THROW(est.update()) << k;
    EXPECT_LE(est.getRSS(), before) << k;
  }
}

/// 3 exp(-0.5 t) + 2 exp(-4 t), exact.
void insertDecays(slom::Estimator& est, const Eigen::Vector4d& start) {
  const auto p = est.insertRV(start, "p");
  for (int i = 0; i < 20; ++i) {
    const double t = 0.2 * i, y = 3 * std::exp(-0.5 * t) + 2 * std::exp(-4 * t);
    est.insertMeasurement(
        [](const auto& v, double at, double z) {
          using std::exp;
          return v[0] * exp(-v[1] * at) + v[2] * exp(-v[3] * at) - z;
        },
        p, t, y, slom::StandardDeviation(0.01));
  }
}

/// Two decays with equal rates are a stationary point with two free directions.
TEST(HardStarts, ASumOfDecaysNeverConvergesAtEqualRates) {
  constexpr int fits = 300;
  Random random(7);
  int optima = 0, saddles = 0;
  for (int k = 0; k < fits; ++k) {
    slom::Estimator est;
    est.setThreads(1);
    insertDecays(est, {random.uniform(-10, 10), random.uniform(-5, 5), random.uniform(-10, 10),
                       random.uniform(-5, 5)});
    slom::Summary summary;
    ASSERT_NO_THROW(summary = est.optimize()) << k;
    if (summary.converged) {
      EXPECT_EQ(summary.free_directions, 0) << k << summary;
      EXPECT_LT(summary.final_rss, 1e-6) << k << summary;
    }
    optima += summary.final_rss < 1e-6;
    saddles += std::abs(summary.final_rss - 12164.7) < 1;
  }
  EXPECT_GT(optima, 0.9 * fits);
  EXPECT_LE(saddles, 1);
}

/// The fit must tell the rates apart. At its start they cannot be told apart to first order.
TEST(HardStarts, EqualRatesAreAStartLikeOthers) {
  for (const double rate : {0.3, 1.0, 2.0}) {
    slom::Estimator est;
    insertDecays(est, {1, rate, 1, rate});
    const slom::Summary summary = est.optimize();
    EXPECT_TRUE(summary.converged) << summary;
    EXPECT_LT(summary.final_rss, 1e-6);
    EXPECT_EQ(summary.free_directions, 0);
  }
}

/// If a fit ends where nothing depends on a parameter any more, the parameter is named.
TEST(HardStarts, AFitOnAPlateauNamesWhatItLeavesFree) {
  slom::Estimator est;
  const auto p = est.insertRV(Eigen::Vector3d(2.1, -2, 9.8), "p");
  const double y[] = {0.007, 0.018, 0.047, 0.119, 0.269, 0.5, 0.731, 0.881, 0.953, 0.982, 0.993};
  for (int x = 0; x <= 10; ++x) {
    est.insertMeasurement(
        [](const auto& v, double at, double z) {
          using std::exp;
          return v[0] / (1.0 + exp(-v[1] * (at - v[2]))) - z;
        },
        p, double(x), y[x], slom::StandardDeviation(0.01));
  }
  const slom::Summary summary = est.optimize();
  if (!summary.converged) {
    EXPECT_EQ(summary.stop_reason, slom::StopReason::rank_deficient) << summary;
    EXPECT_TRUE(summary.parameters.empty());
    EXPECT_EQ(slom::outliers(est).text().find("the last fit has not converged (rank deficient)"), 0u);
    EXPECT_EQ(slom::diagnose(est).text().find("the last fit has not converged (rank deficient)"), 0u);
    est.reinitRV(p, Eigen::Vector3d(1, 1, 5));
    EXPECT_EQ(slom::diagnose(est).text().find("rank 3 of 3"), 0u) << "other values are not those of that fit";
  } else {
    EXPECT_LT(summary.final_rss, 1);
  }
}

/// A user's function that throws in the middle of a fit leaves the best values reached.
TEST(HardStarts, AnExceptionLeavesTheBestValues) {
  for (const auto& algorithm : allAlgorithms()) {
    slom::Estimator est;
    est.setThreads(1);
    est.changeAlgorithm(algorithm->clone().release());
    const auto p = est.insertRV(Eigen::Vector2d(-1.2, 1), "p");
    int calls = 0;
    est.insertMeasurement(
        [&calls](const auto& v) {
          if (++calls > 9) throw std::runtime_error("no more");
          return mtk::vector(10.0 * (v[1] - v[0] * v[0]), 1.0 - v[0]);
        },
        p);
    const double before = est.getRSS();
    EXPECT_THROW(est.optimize(), mtk::Error) << algorithm->name();
    calls = 0;
    EXPECT_LE(est.getRSS(), before) << algorithm->name();
    EXPECT_TRUE((*p).allFinite());
  }
}

/// An IMU that is mounted upside down starts opposite to its measurements.
TEST(HardStarts, OppositeDirectionsAreLeft) {
  for (const double off : {0.0, 1e-200, 1e-9, 1e-3}) {
    for (const auto& algorithm : allAlgorithms()) {
      {
        slom::Estimator est;
        est.changeAlgorithm(algorithm->clone().release());
        const auto R = est.insertRV(mtk::SO3<>::exp(Eigen::Vector3d(off, 0, 0)), "R");
        est.insertMeasurement(slom::GravityDirection(), R, mtk::S2<>(0, 0, 1),
                              slom::measured(mtk::S2<>(0, 0, -1)), slom::StandardDeviation(0.01));
        est.prior(R, mtk::SO3<>(), 10.0);
        const slom::Summary summary = est.optimize();
        EXPECT_TRUE(summary.converged) << summary;
        EXPECT_NEAR(summary.final_rss, 0.0986959, 1e-6) << algorithm->name() << off;
      }
      {
        slom::Estimator est;
        est.changeAlgorithm(algorithm->clone().release());
        const auto d = est.insertRV(mtk::S2<>(off, 0, -1), "d");
        est.insertMeasurement(slom::Prior(), d, slom::measured(mtk::S2<>(0, 0, 1)),
                              slom::StandardDeviation(0.01));
        const slom::Summary summary = est.optimize();
        EXPECT_TRUE(summary.converged) << summary;
        EXPECT_NEAR(summary.final_rss, 0, 1e-9) << algorithm->name() << off;
      }
      {
        slom::Estimator est;
        est.changeAlgorithm(algorithm->clone().release());
        const auto target = est.insertRV(mtk::vect<3>(off, 0, 5), "target");
        est.insertMeasurement(slom::ZenithAngle(), mtk::vect<3>(0, 0, 0), target,
                              slom::measured(mtk::SO2<>(0.1)), slom::StandardDeviation(0.01));
        est.prior(target, mtk::vect<3>(0, 0, 5), 1.0);
        const slom::Summary summary = est.optimize();
        EXPECT_TRUE(summary.converged) << summary;
        EXPECT_NEAR(summary.final_rss, 0.2485, 1e-3) << algorithm->name() << off;
      }
      {
        slom::Estimator est;
        est.changeAlgorithm(algorithm->clone().release());
        const auto p = est.insertRV(mtk::vect<2>(off, 0), "p");
        est.insertMeasurement(slom::Range(), p, mtk::vect<2>(0, 0), slom::measured(1.0),
                              slom::StandardDeviation(0.1));
        est.insertMeasurement(slom::Range(), p, mtk::vect<2>(3, 0), slom::measured(2.5),
                              slom::StandardDeviation(0.1));
        est.insertMeasurement(slom::Range(), p, mtk::vect<2>(0, 3), slom::measured(2.5),
                              slom::StandardDeviation(0.1));
        const slom::Summary summary = est.optimize();
        EXPECT_TRUE(summary.converged) << summary;
        EXPECT_LT(summary.final_rss, 50) << algorithm->name() << off;
      }
    }
  }
}

TEST(HardStarts, LongTurnsAreRotations) {
  for (const double turn : {1e100, 1e154, 1e155, 1e200, 1.7e308}) {
    const mtk::SO3<> R = mtk::SO3<>::exp(mtk::vect<3>(turn, -turn, 0));
    EXPECT_NEAR(R.coeffs().norm(), 1, 1e-12) << turn;
    mtk::S2<> d;
    d.boxplus(mtk::vect<2>(turn, turn / 2));
    EXPECT_NEAR(d.vector().norm(), 1, 1e-12) << turn;
  }
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(std::isnan(mtk::SO3<>::exp(mtk::vect<3>(infinite, 0, 0)).w()));
}

/// Differences stay within bounds. Beyond them, the function may not exist.
TEST(NumericDerivatives, StayWithinBounds) {
  const double infinite = std::numeric_limits<double>::infinity();
  const auto rate = [](double k) { return k < 0 || k > 3 ? std::nan("") : (k + 1.5) * (k + 1.5); };
  for (const double start : {0.0, 1e-9, 1.0, 3.0}) {
    for (const double upper : {3.0, infinite}) {
      for (const bool is_extrapolated : {false, true}) {
        slom::Estimator est;
        const auto k = est.insertRV(start, "k");
        est.bound(k, 0, upper);
        if (upper == infinite && start == 3.0) continue;
        if (is_extrapolated) {
          est.insertMeasurement(slom::numeric(rate, slom::Richardson()), k, slom::StandardDeviation(0.1));
        } else {
          est.insertMeasurement(slom::numeric(rate), k, slom::StandardDeviation(0.1));
        }
        const slom::Summary summary = est.optimize();
        EXPECT_TRUE(summary.converged) << start << summary;
        EXPECT_EQ(*k, 0) << start << summary;
      }
    }
  }
}

/// A simulator with an output of four decimals.
TEST(NumericDerivatives, TakeStepsOfTheUsersOwn) {
  const auto simulate = [](double a, double b, double x, double y) {
    return std::round(1e4 * a * std::exp(-b * x)) / 1e4 - y;
  };
  const auto fit = [&](auto function) {
    slom::Estimator est;
    const auto a = est.insertRV(5.0, "a"), b = est.insertRV(0.9, "b");
    for (int i = 0; i < 50; ++i) {
      const double x = 0.1 * i;
      est.insertMeasurement(function, a, b, x, 3 * std::exp(-0.7 * x), slom::StandardDeviation(0.01));
    }
    slom::Summary summary = est.optimize();
    EXPECT_NEAR(*a, 3, 1e-3) << summary;
    EXPECT_NEAR(*b, 0.7, 1e-3) << summary;
  };
  fit(slom::numeric(simulate, slom::differences(1e-2)));
  fit(slom::numeric(simulate, slom::differences(1e-2, {3.0, 1.0})));
  EXPECT_EQ(messageOf([] { static_cast<void>(slom::differences(0)); }),
            "[slom.bad-option] the step of differences is 0; pass a positive number");
  EXPECT_EQ(messageOf([] {
              static_cast<void>(slom::differences(1e-2, {1.0, -2.0}));
            }),
            "[slom.bad-option] a typical size of differences is -2; pass a positive number");
  slom::Estimator est;
  const auto a = est.insertRV(5.0, "a");
  est.insertMeasurement(slom::numeric([](double v) { return v; }, slom::differences(1e-2, {1.0, 2.0})), a,
                        slom::named("level"));
  EXPECT_EQ(
      messageOf([&] { est.optimize(); }),
      "[slom.bad-option] 2 typical sizes were passed to differences, but measurement level #1 has 1 component of its variables; "
      "pass one for each, or none");
}

TEST(StatedNoise, ReportsSayWhatWasAssumed) {
  const auto fit = [](int stated) {
    slom::Estimator est;
    const auto a = est.insertRV(0.0, "a");
    for (int i = 0; i < 10; ++i) {
      const auto line = [](double v, double y) { return v - y; };
      if (i < stated) {
        est.insertMeasurement(line, a, 1e-3 * (i % 3), slom::StandardDeviation(1e-3));
      } else {
        est.insertMeasurement(line, a, 1e-3 * (i % 3));
      }
    }
    return est.optimize();
  };
  EXPECT_NE(fit(10).report().find("standard deviations are taken as stated\n"), std::string::npos);
  const std::string none = fit(0).report();
  EXPECT_NE(none.find("no standard deviation was stated, 1 is assumed; the residuals show 0.000876; "
                      "setSigma(slom::Sigma::estimated) adopts this value"),
            std::string::npos)
      << none;
  EXPECT_NE(fit(0).json().find("\"stated_noise\": \"none\""), std::string::npos);
}

TEST(HardStarts, AFarStartIsNoMatterOfRank) {
  // A line with terms in very different units. At a far start, residuals are so large that their rounding errors hide
  // the effect of q.
  for (const double far : {1.0, -5.0, 1e3, 1e6, 2.02e9}) {
    for (const double unit : {1e18, 1e20, 1e21}) {
      slom::Estimator est;
      const double p_true = 2e9, q_true = 3e9 / unit;
      const auto p = est.insertRV(far, "p"), q = est.insertRV(far == 2.02e9 ? 1.01 * q_true : 1.0, "q");
      for (int i = 1; i <= 10; ++i) {
        est.insertMeasurement([](const auto& a, const auto& b, double t, double y,
                                 double in) { return a * t + b * (in * t * t) - y; },
                              p, q, double(i), p_true * i + q_true * (unit * i * i), unit,
                              slom::StandardDeviation(1e3));
      }
      const slom::Summary summary = est.optimize();
      EXPECT_TRUE(summary.converged) << far << " " << unit << "\n" << summary;
      EXPECT_NEAR(*p / p_true, 1, 1e-9) << far << " " << unit;
      EXPECT_NEAR(*q / q_true, 1, 1e-9) << far << " " << unit;
    }
  }
}

}  // namespace
