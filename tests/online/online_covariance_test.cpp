// Covariances between updates: equal to those of the batch fit, and refused if there are none.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>
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

/// Computes the marginals of a walk with closures after each step. Returns the largest norm of an error, relative to
/// the tolerance and 1e-12.
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

/// Returns levelling lines whose heights are not connected with the ground, or one connection that is 1 / `least` as
/// exact as the best.
Estimator freeNet(int seed, int points, double least, std::vector<VarID<double>>& heights,
                  const std::function<void(Estimator&)>& after_each) {
  std::mt19937 random(static_cast<std::mt19937::result_type>(seed));
  const auto uniform = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  const auto difference = [](const auto& a, const auto& b) { return a - b; };
  Estimator est;
  const VarID<double> ground = est.insertRV(0.0, false, "ground");
  heights = {est.insertRV(5.0, "h0")};
  if (least > 0) est.insertMeasurement(difference, ground, heights[0], StandardDeviation(1e-3 / least));
  for (int i = 1; i < points; ++i) {
    heights.push_back(est.insertRV(5.0, "h" + std::to_string(i)));
    for (int k = 0; k < 1 + i % 3; ++k) {
      const int from = k == 0 ? i - 1 : static_cast<int>(uniform(0, i));
      est.insertMeasurement(difference, heights[static_cast<std::size_t>(from)], heights.back(),
                            StandardDeviation(1e-3 * std::pow(10, uniform(0, 2))));
    }
    after_each(est);
  }
  return est;
}

TEST(OnlineFit, NamesWhatIsFreeHoweverRoundingErrorsFall) {
  std::vector<VarID<double>> heights;
  for (int seed = 0; seed < 40; ++seed) {
    freeNet(seed, 60, 0, heights, [&](Estimator& est) {
      ASSERT_EQ(est.update().undetermined.size(), 1u) << seed << " " << heights.size();
    });
  }
}

TEST(OnlineFit, KnowsWhatOnlyAWeakMeasurementDetermines) {
  std::vector<VarID<double>> heights;
  for (int seed = 0; seed < 10; ++seed) {
    for (const double least : {1e-3, 1e-4, 1e-5, 1e-6}) {
      Estimator est = freeNet(seed, 60, least, heights, [&](Estimator& e) {
        ASSERT_EQ(e.update().undetermined, std::vector<std::string>()) << seed << " " << heights.size();
      });
      const double exact = 1e-3 / least;  // next to which the lines are exact
      EXPECT_NEAR(est.updatedMarginals().standardDeviation(heights.back())[0], exact, 1e-2 * exact) << least;
      EXPECT_NEAR(std::sqrt(est.updatedCovariance(heights[30])(0, 0)), exact, 1e-2 * exact) << least;
    }
  }
}

TEST(OnlineFit, RefusesMarginalsThatItDoesNotHave) {
  Estimator est;
  const auto a = est.insertRV(Point(1, 2), "a"), b = est.insertRV(Point(1, 2), "b");
  est.insertMeasurement([](const auto& p) { return p[0] - 3; }, a);
  est.insertMeasurement([](const auto& p) { return p; }, b);
  EXPECT_EQ(testing::messageOf([&] { est.updatedMarginals(); }),
            "[slom.not-updated] no marginals of an update: update() was never called; call "
            "update() first, or ask marginals()");
  est.update();
  EXPECT_EQ(
      testing::messageOf([&] { est.updatedMarginals(); }),
      "[slom.rank-deficient] variable a has no covariance, because no measurement determines a.y; add a "
      "measurement, or fix a.y");
  for (const double tolerance : {-1e-3, 1.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(testing::messageOf([&] { est.updatedMarginals(tolerance); }).substr(0, 47),
              "[slom.bad-option] the tolerance of marginals is");
  }
  EXPECT_EQ(
      testing::messageOf([&] { est.updatedMarginals(1); }),
      "[slom.bad-option] the tolerance of marginals is 1; pass a number from 0 to below 1, such as 1e-3");
  est.insertMeasurement([](const auto& p) { return p; }, a);
  EXPECT_EQ(testing::messageOf([&] { est.updatedMarginals(); }),
            "[slom.not-updated] no marginals of an update: the problem has changed since, or "
            "optimize() took over; call update() first, or ask marginals()");
  est.update();
  EXPECT_LT((est.updatedMarginals().covariance(b) - Eigen::Matrix2d::Identity()).norm(), 1e-12);
  est.bound(b, "x", -10, 10);
  est.update();
  EXPECT_EQ(
      testing::messageOf([&] { est.updatedMarginals(); }),
      "[slom.not-updated] no marginals of an update: update() leaves problems with bounds to optimize(); ask "
      "marginals()");
}

TEST(OnlineFit, RefusesCovariancesThatItDoesNotHave) {
  Estimator est;
  const auto a = est.insertRV(Point(1, 2), "a"), b = est.insertRV(Point(1, 2), "b");
  est.insertMeasurement([](const auto& p) { return p[0] - 3; }, a);
  est.insertMeasurement([](const auto& p) { return p; }, b);
  EXPECT_EQ(testing::messageOf([&] { est.updatedCovariance(a); }),
            "[slom.not-updated] no covariance of an update for variable a: update() was never "
            "called; call update() first, or ask covariance()");
  est.update();
  EXPECT_EQ(
      testing::messageOf([&] { est.updatedCovariance(a); }),
      "[slom.rank-deficient] variable a has no covariance, because no measurement determines a.y; add a "
      "measurement, or fix a.y");
  EXPECT_LT((est.updatedCovariance(b) - Eigen::Matrix2d::Identity()).norm(), 1e-12);
  est.reinitRV(b, Point(2, 2));
  EXPECT_EQ(testing::messageOf([&] { est.updatedCovariance(b); }),
            "[slom.not-updated] no covariance of an update for variable b: the problem has changed "
            "since, or optimize() took over; call update() first, or ask covariance()");
  est.bound(b, "x", -10, 10);
  est.update();
  EXPECT_EQ(
      testing::messageOf([&] { est.updatedCovariance(b); }),
      "[slom.not-updated] no covariance of an update for variable b: update() leaves problems with bounds to "
      "optimize(); ask covariance()");
}

}  // namespace
}  // namespace slom
