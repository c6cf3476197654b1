// Splines in an estimator: coverage, growth, measurements that move to other segments, and errors.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include <slom/slom.hpp>

#include "support/message_of.hpp"
#include "trajectory/random_segments.hpp"

namespace slom {
namespace {

using testing::messageOf;
using trajectory::insertMeasurement;
using trajectory::Knots;
using trajectory::PoseSpline;
using trajectory::RotationSpline;
using trajectory::VectorSpline;

struct Height {
  auto operator()(const auto& x, double t) const { return x.at(t); }
};
const auto kValue = [](const auto& x, double t) { return x.at(t); };

TEST(Spline, CoversTheTimesAskedFor) {
  Estimator est;
  VectorSpline<1, 4> x(Knots(0, 1), "x");
  EXPECT_GT(x.firstTime(), x.lastTime());
  x.extend(est, 2.5, 5.5);
  EXPECT_EQ(x.firstTime(), 2);
  EXPECT_EQ(x.lastTime(), 6);
  EXPECT_EQ(x.controls().size(), 7u);
  EXPECT_EQ(est.nameOf(x.controls().front()), "x[2]");
  x.extend(est, 6, 6);
  x.extend(est, -1, 0);
  EXPECT_EQ(x.firstTime(), -1);
  EXPECT_EQ(x.lastTime(), 7);
  EXPECT_EQ(est.nameOf(x.controls().front()), "x[-1]");
  EXPECT_EQ(x.segmentAt(7).at(7)[0], 0);  // the last time belongs to the last segment
  VectorSpline<1, 4> exact(Knots(0, 1), "exact");
  exact.extend(est, 0, 3);
  EXPECT_EQ(exact.lastTime(), 3);
}

TEST(Spline, ContinuesTheMotion) {
  Estimator est;
  PoseSpline<5> pose(Knots({0, 1, 1.5, 3}), "pose");
  const mtk::vect<3> turn(0.1, -0.2, 0.3);
  pose.extend(est, 0.5, 2, [&](double t) {
    return mtk::trafo<mtk::SO3<>>(mtk::vect<3>(t, 2 * t, 0), mtk::SO3<>::exp(t * turn));
  });
  pose.extend(est, -7, 12);
  for (double t = -7; t <= 12; t += 0.25) {
    const auto segment = pose.segmentAt(t);
    EXPECT_LT((segment.positionAt(t) - mtk::vect<3>(t, 2 * t, 0)).norm(), 1e-12) << t;
    EXPECT_LT((segment.angularVelocityAt(t) - turn).norm(), 1e-12) << t;
  }
}

TEST(Spline, RefusesTimesThatItDoesNotCover) {
  Estimator est;
  VectorSpline<1, 4> x(Knots(0, 1), "height");
  EXPECT_EQ(
      messageOf([&] { x.segmentAt(0.5); }),
      "[slom.uncovered-time] spline height has no control points yet, and the time is 0.5; call extend(est, from, to) "
      "first");
  x.extend(est, 0, 10);
  EXPECT_EQ(
      messageOf([&] { insertMeasurement(est, kValue, x.around(11.5), 11.5, measured(mtk::vect<1>(1.0))); }),
      "[slom.uncovered-time] spline height covers the times from 0 to 10, and the time is 11.5; call extend(est, "
      "from, to) first");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(messageOf([&] { x.segmentAt(nan); }),
            "[slom.bad-time] the time on a spline is nan; pass a finite number");
  EXPECT_EQ(messageOf([&] { x.extend(est, 0, nan); }),
            "[slom.bad-time] the time on a spline is nan; pass a finite number");
  EXPECT_EQ(
      messageOf([&] { x.extend(est, 5, 2); }),
      "[slom.bad-time] spline height is to cover the times from 5 to 2, which is earlier; exchange them");
  EXPECT_EQ(est.getM(), 0);
}

TEST(Spline, FitsSamplesExactly) {
  Estimator est;
  RotationSpline<4> R(Knots(0, 0.5), "R");
  R.extend(est, 0, 5);
  const auto truth = [](double t) {
    return mtk::SO3<>::exp(mtk::vect<3>(std::sin(t), 0.3 * t, std::cos(t)));
  };
  const auto orientation = [](const auto& segment, double t) { return segment.orientationAt(t); };
  for (double t = 0; t <= 5; t += 0.1) {
    insertMeasurement(est, orientation, R.around(t), t, measured(truth(t)), StandardDeviation(1e-3),
                      named("attitude"));
  }
  const Summary summary = est.optimize();
  EXPECT_TRUE(summary.converged);
  EXPECT_EQ(summary.groups.front().name, "attitude");
  for (double t = 0; t <= 5; t += 0.03) {
    EXPECT_LT(mtk::difference(R.segmentAt(t).orientationAt(t), truth(t)).norm(), 1e-3);
  }
}

TEST(Spline, MeasurementsMayHaveSeveralSplines) {
  Estimator est;
  VectorSpline<2, 4> x(Knots(0, 1), "x");
  VectorSpline<2, 3> bias(Knots(0, 4), "bias");
  x.extend(est, 0, 8);
  bias.extend(est, 0, 8);
  const auto biased = [](const auto& a, const auto& b, const auto& scale, double t) {
    return scale * a.at(t) + b.at(t);
  };
  const auto scale = est.insertRV(2.0, "scale");
  const auto placed =
      insertMeasurement(est, biased, x.around(3.5), bias.around(3.5), scale, 3.5,
                        measured(mtk::vect<2>(1, 2)), StandardDeviation(0.1), Huber(3), group(7));
  EXPECT_EQ(est.residual(placed.id()), Eigen::Vector2d(-1, -2));
  EXPECT_EQ(est.getRSS(x.controls()[2]), 0);
  EXPECT_GT(est.getRSS(x.controls()[3]), 0);
  est.removeMeasurement(placed.id());
  EXPECT_EQ(est.getM(), 0);
}

TEST(Spline, MeasurementsHaveTheNameOfTheirFunction) {
  Estimator est;
  VectorSpline<1, 4> x(Knots(0, 1), "x");
  x.extend(est, 0, 4);
  const auto unnamed = insertMeasurement(est, Height(), x.around(1.5), 1.5, measured(mtk::vect<1>(1.0)));
  const auto label =
      insertMeasurement(est, Height(), x.around(1.5), 1.5, measured(mtk::vect<1>(1.0)), named("tide"));
  EXPECT_EQ(est.nameOf(unnamed.id()), "Height #1");
  EXPECT_EQ(est.nameOf(label.id()), "tide #1");
}

TEST(Spline, NumericFunctionsStayNumeric) {
  Estimator est;
  VectorSpline<1, 4> x(Knots(0, 1), "x");
  x.extend(est, 0, 4);
  insertMeasurement(est, numeric(kValue), x.around(1.5), 1.5, measured(mtk::vect<1>(1.0)));
  insertMeasurement(est, kValue, x.around(1.5), 1.5, measured(mtk::vect<1>(1.0)));
  const DerivativeCheck check = checkDerivatives(est);
  EXPECT_TRUE(check.ok()) << check;
  ASSERT_EQ(check.groups.size(), 2u);
  EXPECT_EQ(check.groups[0].source, DerivativeSource::numeric);
  EXPECT_EQ(check.groups[1].source, DerivativeSource::exact);
}

TEST(Spline, TiesItsEnds) {
  Estimator est;
  VectorSpline<1, 4> x(Knots(0, 1), "x");
  x.extend(est, 0, 10, [](double t) { return mtk::vect<1>(t * t); });
  x.tieEnds(est);
  x.tieEnds(est);
  EXPECT_EQ(est.getM(), 6);
  EXPECT_NEAR(est.getRMS(), 1 / (3 * std::sqrt(11.0 / 13)), 1e-12);  // 11 changes by 2 of 13 control points
  insertMeasurement(est, kValue, x.around(5.5), 5.5, measured(mtk::vect<1>(1.0)));
  x.trim(est);
  EXPECT_EQ(x.firstTime(), 5);
  EXPECT_EQ(x.lastTime(), 6);
  EXPECT_EQ(est.getM(), 1);
}

/// A measurement of x at stamp + offset.
struct Moved : ::testing::Test {
  Estimator est;
  VectorSpline<1, 4> x{Knots(0, 1), "x"};
  VarID<double> offset = est.insertRV(0.0, "offset");
  trajectory::Placed place(double stamp) {
    const auto f = [](const auto& segment, const auto& by, double t) { return segment.at(t + by); };
    return insertMeasurement(est, f, x.around(stamp, offset), offset, stamp, measured(mtk::vect<1>(1.0)));
  }
};

TEST_F(Moved, MeasurementsFollowTheirTimes) {
  x.extend(est, 0, 10, [](double t) { return mtk::vect<1>(t * t); });
  const auto placed = place(2.5);
  const double at_start = est.residual(placed.id())[0];
  EXPECT_FALSE(x.isLeft());
  EXPECT_EQ(x.follow(est), 0);
  est.reinitRV(offset, 3.25);
  EXPECT_TRUE(x.isLeft());
  EXPECT_EQ(x.follow(est), 1);
  EXPECT_FALSE(x.isLeft());
  EXPECT_EQ(x.firstTime(), 5);  // trimmed to the only segment with a measurement
  EXPECT_EQ(x.lastTime(), 6);
  EXPECT_NEAR(est.residual(placed.id())[0] - at_start, 5.75 * 5.75 - 2.5 * 2.5, 1e-12);
  EXPECT_EQ(est.getM(), 1 + 4);  // and the ends are tied
}

TEST_F(Moved, SplinesGrowAtBothEnds) {
  x.extend(est, 0, 10, [](double t) { return mtk::vect<1>(3 * t); });
  const auto first = place(0.5), last = place(9.5);
  for (const double by : {700.25, -1000.5, 0.0}) {
    est.reinitRV(offset, by);
    int rounds = 0;
    while (x.follow(est) > 0) ++rounds;
    EXPECT_EQ(rounds, by == 0 ? 4 : by > 0 ? 3 : 7);  // 256 segments at a time
    EXPECT_NEAR(est.residual(first.id())[0], 3 * (0.5 + by) - 1, 1e-9);
    EXPECT_NEAR(est.residual(last.id())[0], 3 * (9.5 + by) - 1, 1e-9);
    EXPECT_LE(x.firstTime(), 0.5 + by);
    EXPECT_GE(x.lastTime(), 9.5 + by);
    EXPECT_LE(x.controls().size(), 14u);
  }
}

TEST_F(Moved, TimesNextToAKnotStay) {
  x.extend(est, 0, 10);
  place(2.5);
  est.reinitRV(offset, 0.5 + 1e-9);
  EXPECT_EQ(x.follow(est), 0);
  est.reinitRV(offset, 0.5 + 1e-3);
  EXPECT_EQ(x.follow(est), 1);
}

TEST_F(Moved, OptionsAreChecked) {
  x.extend(est, 0, 10);
  place(2.5);
  EXPECT_EQ(messageOf([&] { trajectory::optimize(est, {x}, {.max_seconds = -1}); }),
            messageOf([&] { est.optimize({.max_seconds = -1}); }));
  EXPECT_EQ(messageOf([&] { trajectory::optimize(est, {x}, {.max_iterations = -7}); }),
            messageOf([&] { est.optimize({.max_iterations = -7}); }));
}

TEST_F(Moved, RemovedMeasurementsStayRemoved) {
  x.extend(est, 0, 10);
  const auto placed = place(2.5);
  est.removeMeasurement(placed.id());
  est.reinitRV(offset, 3.0);
  EXPECT_FALSE(x.isLeft());
  EXPECT_EQ(x.follow(est), 0);
  EXPECT_EQ(est.getM(), 0);
}

TEST_F(Moved, AnySplineOfAMeasurementMovesIt) {
  x.extend(est, 0, 10);
  VectorSpline<1, 3> bias(Knots(0, 1), "bias");
  bias.extend(est, 0, 10);
  const auto f = [](const auto& a, const auto& b, const auto& by, double t) {
    return a.at(t + by) + b.at(t);
  };
  insertMeasurement(est, f, x.around(2.5, offset), bias.around(2.5), offset, 2.5,
                    measured(mtk::vect<1>(1.0)));
  est.reinitRV(offset, 3.0);
  EXPECT_TRUE(bias.isLeft());
  EXPECT_EQ(bias.follow(est), 1);
  EXPECT_EQ(x.follow(est), 0);
  EXPECT_EQ(x.firstTime(), 5);
  EXPECT_EQ(bias.firstTime(), 2);
}

TEST_F(Moved, MeasurementsOnSplinesThatAreGoneStay) {
  x.extend(est, 0, 10);
  {
    VectorSpline<1, 3> bias(Knots(0, 1), "bias");
    bias.extend(est, 0, 10);
    const auto f = [](const auto& a, const auto& b, const auto& by, double t) {
      return a.at(t + by) + b.at(t + by);
    };
    insertMeasurement(est, f, x.around(2.5, offset), bias.around(2.5, offset), offset, 2.5,
                      measured(mtk::vect<1>(1.0)));
  }
  est.reinitRV(offset, 3.0);
  EXPECT_FALSE(x.isLeft());
  EXPECT_EQ(x.follow(est), 0);
  EXPECT_EQ(est.getM(), 1);
}

TEST_F(Moved, TimesAreAnyFunctionOfVariables) {
  x.extend(est, 0, 10, [](double t) { return mtk::vect<1>(t); });
  const auto delay = est.insertRV(0.01, "line delay");
  const auto f = [](const auto& segment, const auto& d, double t, int row) {
    return segment.at(t + row * d);
  };
  const auto placed = insertMeasurement(est, f, x.around([delay] { return 1.0 + 100 * *delay; }), delay, 1.0,
                                        100, measured(mtk::vect<1>(0.0)));
  EXPECT_NEAR(est.residual(placed.id())[0], 2, 1e-14);
  est.reinitRV(delay, 0.08);
  EXPECT_EQ(x.follow(est), 1);
  EXPECT_NEAR(est.residual(placed.id())[0], 9, 1e-14);
}

}  // namespace
}  // namespace slom
