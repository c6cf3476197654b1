// If functions are linear, a window that forgets gives the same result as all data together.
#include "slom/fixed_lag.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "slom/slom.hpp"
#include "support/message_of.hpp"

namespace slom {
namespace {

using Point = mtk::vect<2>;
using testing::messageOf;

/// A walk with an odometer, occasional position fixes, other fixes with an unknown offset, and a beacon that is seen
/// for a while.
struct Walk {
  Estimator est;
  VarID<Point> offset = est.insertRV(Point(0, 0), "offset"), beacon = est.insertRV(Point(1, 1), "beacon");
  std::vector<VarID<Point>> points;
  std::mt19937 rng{5};

  Walk() { est.prior(offset, Point(0, 0), 100.); }
  double noise() { return std::normal_distribution<>()(rng); }
  Point noisy(double x, double y) { return {x + noise(), y + noise()}; }

  void step() {
    const int k = int(points.size());
    points.push_back(est.insertRV(Point(k, 0)));
    const auto now = points.back();
    if (k > 0) {
      est.insertMeasurement([](const auto& a, const auto& b) { return b - a; }, points[std::size_t(k - 1)],
                            now, measured(noisy(1, 0)), StandardDeviation(0.1));
    }
    if (k % 7 == 3) {
      est.insertMeasurement([](const auto& x, const auto& o) { return x + o; }, now, offset,
                            measured(noisy(k + 3, 4)), StandardDeviation(1.));
    }
    if (k % 50 == 0) {
      est.insertMeasurement([](const auto& x) { return x; }, now, measured(noisy(k, 0)),
                            StandardDeviation(0.5));
    }
    if (k < 30) {
      est.insertMeasurement([](const auto& x, const auto& b) { return b - x; }, now, beacon,
                            measured(noisy(10 - k, 5)), StandardDeviation(0.3));
    }
  }
};

TEST(FixedLag, EndsAtTheOptimumOfAllData) {
  Walk all, window;
  FixedLag lag({.variables = 12});
  int gone = 0;
  for (int k = 0; k < 400; ++k) {
    all.step();
    window.step();
    lag.add(window.points.back());
    ASSERT_TRUE(window.est.optimize().converged);
    gone += lag.forget(window.est);
    ASSERT_LE(lag.size(), 12);
    ASSERT_LE(window.est.getN(), 2 * 14);
    ASSERT_LT(window.est.getM(), 150) << k;
  }
  EXPECT_EQ(gone, 388);
  ASSERT_TRUE(all.est.optimize().converged);
  EXPECT_LT((*all.points.back() - *window.points.back()).norm(), 1e-8);
  EXPECT_LT((*all.offset - *window.offset).norm(), 1e-8);
  EXPECT_LT((*all.beacon - *window.beacon).norm(), 1e-8);
  const auto C = all.est.jointCovariance(all.points.back(), all.beacon, all.offset);
  EXPECT_LT((C - window.est.jointCovariance(window.points.back(), window.beacon, window.offset)).norm(),
            1e-8 * C.norm());
}

TEST(FixedLag, CountsWhatComesLate) {
  Estimator all, window;
  FixedLag lag({.duration = 5});
  const auto start_all = all.insertRV(0.0), start = window.insertRV(0.0);
  const auto insert = [](Estimator& est, const VarID<double>& from, double step) {
    const auto next = est.insertRV(0.0);
    est.insertMeasurement([](const auto& a, const auto& b) { return b - a; }, from, next, measured(step));
    return next;
  };
  const auto fix = [](Estimator& est, const VarID<double>& x, double value) { est.prior(x, value, 2.); };
  fix(all, start_all, 0);
  fix(window, start, 0);
  lag.add(start, 0);
  auto a = start_all, w = start;
  for (int k = 1; k <= 20; ++k) {
    a = insert(all, a, 1);
    w = insert(window, w, 1);
    lag.add(w, k);
    window.optimize();
    lag.forget(window);
    if (k == 12) {  // a photograph of time 3, developed at last, seen from what is there now
      const auto old_all = insert(all, a, -9.5), old = insert(window, w, -9.5);
      fix(all, old_all, 2);
      fix(window, old, 2);
      lag.add(old, 3);
      window.optimize();
      EXPECT_EQ(lag.forget(window), 1);
      EXPECT_FALSE(old.isValid());
    }
  }
  EXPECT_EQ(lag.size(), 6);
  all.optimize();
  EXPECT_NEAR(*a, *w, 1e-10);
  EXPECT_NEAR(all.standardDeviation(a)[0], window.standardDeviation(w)[0], 1e-10);
}

TEST(FixedLag, KeepsWhatIsSeenAgain) {
  Estimator est;
  FixedLag lag({.variables = 2});
  std::vector<VarID<double>> x;
  for (int i = 0; i < 4; ++i) {
    x.push_back(est.insertRV(double(i)));
    est.prior(x.back(), 1., 1.);
    lag.add(x.back());
    lag.add(x.front());
    lag.forget(est);
  }
  EXPECT_TRUE(x[0].isValid());
  EXPECT_FALSE(x[1].isValid());
  EXPECT_FALSE(x[2].isValid());
  EXPECT_TRUE(x[3].isValid());
}

TEST(FixedLag, ForgetsWhatWasRemovedOtherwise) {
  Estimator est;
  FixedLag lag({.variables = 1});
  EXPECT_EQ(lag.forget(est), 0);
  const auto a = est.insertRV(1.0), b = est.insertRV(2.0);
  lag.add(a);
  lag.add(b);
  est.removeRV(a);
  EXPECT_EQ(lag.forget(est), 0);
  EXPECT_EQ(lag.size(), 1);
  est.removeRV(b);
  EXPECT_EQ(lag.forget(est), 0);
  EXPECT_EQ(lag.size(), 0);
}

TEST(FixedLag, StaysAsItIsWhereMarginalizingFails) {
  Estimator est;
  FixedLag lag({.variables = 1});
  const auto a = est.insertRV(-1.0, "a"), b = est.insertRV(2.0, "b");
  est.insertMeasurement([](const auto& x, const auto& y) { return sqrt(x) - y; }, a, b, measured(1.0));
  lag.add(a);
  lag.add(b);
  EXPECT_EQ(messageOf([&] { lag.forget(est); }).substr(0, 17), "[slom.not-finite]");
  EXPECT_EQ(lag.size(), 2);
  est.reinitRV(a, 4.0);
  EXPECT_EQ(lag.forget(est), 1);
}

TEST(FixedLag, NamesBadOptions) {
  EXPECT_EQ(messageOf([] { FixedLag lag({.variables = 0}); }),
            "[slom.bad-option] the window of a FixedLag has 0 variables; pass a positive number, such as 50");
  EXPECT_EQ(
      messageOf([] { FixedLag lag({.duration = -1}); }),
      "[slom.bad-option] the duration of a FixedLag is -1.000000; pass a number that is not negative, such as 10");
  Estimator est;
  const auto a = est.insertRV(1.0);
  FixedLag lag({.variables = 1});
  EXPECT_EQ(messageOf([&] { lag.add(a, std::nan("")); }),
            "[slom.bad-time] the time of a variable in a FixedLag is nan; pass a finite number");
}

}  // namespace
}  // namespace slom
