// Covariances between updates: those of the batch fit, and refused where there are none.
#include <algorithm>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include <slom/slom.hpp>

#include "support/message_of.hpp"

namespace slom {
namespace {

using Point = mtk::vect<2>;

TEST(OnlineFit, HasTheCovariancesOfALinearProblemToTheLastDigits) {
  Estimator est;
  std::vector<VarID<Point>> chain{est.insertRV(Point(0, 0), false, "origin")};
  for (int i = 1; i < 30; ++i) {
    chain.push_back(est.insertRV(Point(i, 0)));
    est.insertMeasurement([](const auto& a, const auto& b) { return b - a; }, chain[chain.size() - 2],
                          chain.back(), slom::measured(Point(1, 0.1)), StandardDeviation(0.1));
    if (i % 7 == 0) {
      est.insertMeasurement([](const auto& a, const auto& b) { return b - a; }, chain[std::size_t(i - 5)],
                            chain.back(), slom::measured(Point(5, 0.5)), StandardDeviation(0.2));
    }
    est.update();
    EXPECT_LT((est.updatedCovariance(chain.back()) - est.covariance(chain.back())).norm(), 1e-12);
    EXPECT_LT((est.updatedCovariance(chain[chain.size() / 2], chain.back()) -
               est.covariance(chain[chain.size() / 2], chain.back()))
                  .norm(),
              1e-12);
  }
  EXPECT_EQ(est.updatedCovariance(chain[0]).norm(), 0);
  EXPECT_EQ(est.updatedCovariance(chain[0], chain[3]).norm(), 0);
  est.fix(chain[5], "y");
  est.update();
  EXPECT_LT((est.updatedCovariance(chain[5]) - est.covariance(chain[5])).norm(), 1e-12);
  EXPECT_EQ(est.updatedCovariance(chain[5])(1, 1), 0);
  est.setSigma(Sigma::estimated);
  EXPECT_LT((est.updatedCovariance(chain[7]) - est.covariance(chain[7])).norm(), 1e-12);
}

/// A walk with closures, whose marginals are asked for after each step. Returns the largest norm of an error, relative to the tolerance and 1e-12.
double largestErrorOfMarginals(double tolerance) {
  Estimator est;
  std::vector<VarID<Point>> points{est.insertRV(Point(0, 0), false, "origin")};
  std::mt19937 random(5);
  const auto step = [](const auto& a, const auto& b) { return b - a; };
  double largest = 0;
  for (int i = 1; i < 300; ++i) {
    points.push_back(est.insertRV(Point(i, 0)));
    const auto last = points[points.size() - 2];
    const auto other = points[std::uniform_int_distribution<std::size_t>(0, points.size() - 2)(random)];
    est.insertMeasurement(step, last, points.back(), slom::measured(Point(1, 0.1)), StandardDeviation(0.1));
    if (i % 20 == 0 && other != last) {
      est.insertMeasurement(step, other, points.back(), slom::measured(Point(5, 0.5)),
                            StandardDeviation(0.2));
    }
    if (i == 20) est.fix(points[5], "y");
    if (i == 290) est.setSigma(Sigma::estimated);
    est.update();
    const slom::Marginals online = est.updatedMarginals(tolerance), batch = est.marginals();
    for (const auto& p : points) {
      const Eigen::MatrixXd C = batch.covariance(p);
      const double error = (online.covariance(p) - C).norm();
      largest = std::max(largest, error / (1e-12 * (1 + C.norm()) + tolerance * online.covariance(p).norm()));
    }
  }
  EXPECT_EQ(est.updatedMarginals().covariance(points[0]).norm(), 0);
  EXPECT_EQ(est.updatedMarginals().covariance(points[5])(1, 1), 0);
  const slom::Marginals before = est.updatedMarginals();
  EXPECT_EQ(testing::messageOf([&] { before.covariance(est.insertRV(Point(1, 1))); }),
            "[slom.stale-marginals] the VarID<" + slom::typeName<Point>() +
                "> refers to a variable that was not in the problem when the marginals were computed; call "
                "marginals() again, of the estimator that holds it");
  return largest;
}

TEST(OnlineFit, HasTheMarginalsOfALinearProblemWithinTheTolerance) {
  EXPECT_LT(largestErrorOfMarginals(0), 1);
  const double with_tolerance = largestErrorOfMarginals(0.1);
  EXPECT_LT(with_tolerance, 1);
  EXPECT_GT(with_tolerance, 0.01);  // something was left as it was
}

TEST(OnlineFit, RefusesMarginalsThatItDoesNotHave) {
  Estimator est;
  const auto a = est.insertRV(Point(1, 2), "a"), b = est.insertRV(Point(1, 2), "b");
  est.insertMeasurement([](const auto& p) { return p[0] - 3; }, a);
  est.insertMeasurement([](const auto& p) { return p; }, b);
  EXPECT_EQ(testing::messageOf([&] { est.updatedMarginals(); }),
            "[slom.not-updated] marginals of an update were asked for, but update() was never called; call "
            "update() first, or ask marginals()");
  est.update();
  EXPECT_EQ(
      testing::messageOf([&] { est.updatedMarginals(); }),
      "[slom.rank-deficient] variable a has no covariance, as no measurement determines a.y; add one, or "
      "fix a.y");
  for (const double tolerance : {-1e-3, 1.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(testing::messageOf([&] { est.updatedMarginals(tolerance); }).substr(0, 47),
              "[slom.bad-option] the tolerance of marginals is");
  }
  EXPECT_EQ(
      testing::messageOf([&] { est.updatedMarginals(1); }),
      "[slom.bad-option] the tolerance of marginals is 1; pass a number from 0 to below 1, such as 1e-3");
  est.insertMeasurement([](const auto& p) { return p; }, a);
  EXPECT_EQ(testing::messageOf([&] { est.updatedMarginals(); }),
            "[slom.not-updated] marginals of an update were asked for, but the problem has changed since, or "
            "optimize() took over; call update() first, or ask marginals()");
  est.update();
  EXPECT_LT((est.updatedMarginals().covariance(b) - Eigen::Matrix2d::Identity()).norm(), 1e-12);
  est.bound(b, "x", -10, 10);
  est.update();
  EXPECT_EQ(
      testing::messageOf([&] { est.updatedMarginals(); }),
      "[slom.not-updated] marginals of an update were asked for, but there are bounds, and update() leaves "
      "such fits to optimize(); ask marginals()");
}

TEST(OnlineFit, RefusesCovariancesThatItDoesNotHave) {
  Estimator est;
  const auto a = est.insertRV(Point(1, 2), "a"), b = est.insertRV(Point(1, 2), "b");
  est.insertMeasurement([](const auto& p) { return p[0] - 3; }, a);
  est.insertMeasurement([](const auto& p) { return p; }, b);
  EXPECT_EQ(testing::messageOf([&] { est.updatedCovariance(a); }),
            "[slom.not-updated] covariances of an update were asked for variable a, but update() was never "
            "called; call update() first, or ask covariance()");
  est.update();
  EXPECT_EQ(
      testing::messageOf([&] { est.updatedCovariance(a); }),
      "[slom.rank-deficient] variable a has no covariance, as no measurement determines a.y; add one, or "
      "fix a.y");
  EXPECT_LT((est.updatedCovariance(b) - Eigen::Matrix2d::Identity()).norm(), 1e-12);
  est.reinitRV(b, Point(2, 2));
  EXPECT_EQ(
      testing::messageOf([&] { est.updatedCovariance(b); }),
      "[slom.not-updated] covariances of an update were asked for variable b, but the problem has changed "
      "since, or optimize() took over; call update() first, or ask covariance()");
  est.bound(b, "x", -10, 10);
  est.update();
  EXPECT_EQ(
      testing::messageOf([&] { est.updatedCovariance(b); }),
      "[slom.not-updated] covariances of an update were asked for variable b, but there are bounds, and "
      "update() leaves such fits to optimize(); ask covariance()");
}

}  // namespace
}  // namespace slom
