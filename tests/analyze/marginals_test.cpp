// Marginals answer for the variables for which they were computed. Parameter tables agree with standardDeviation.
#include <gtest/gtest.h>

#include <slom/slom.hpp>

#include "support/message_of.hpp"

namespace {

using slom::testing::messageOf;
using Point = mtk::vect<2>;

slom::VarID<Point> insertMeasured(slom::Estimator& est, double sigma, const std::string& name) {
  const auto id = est.insertRV(Point(1, 2), name);
  est.insertMeasurement([](const auto& p) { return p; }, id, slom::measured(Point(1, 2)),
                        slom::StandardDeviation(sigma));
  return id;
}

TEST(Marginals, KnowTheirVariablesWhateverIsRemovedAndInserted) {
  slom::Estimator est;
  const auto a = insertMeasured(est, 0.1, "a");
  const auto b = est.insertRV(Point(3, 4), "b");
  const auto datum = est.insertMeasurement([](const auto& p) { return p; }, b, slom::measured(Point(3, 4)),
                                           slom::StandardDeviation(0.2));
  const slom::Marginals marginals = est.marginals();
  est.removeMeasurement(datum);
  est.removeRV(b);
  const auto c = insertMeasured(est, 0.3, "c");  // in the slot of b
  EXPECT_NEAR(marginals.standardDeviation(a)[0], 0.1, 1e-12);
  EXPECT_NEAR(marginals.standardDeviation(b)[1], 0.2, 1e-12) << "as it was when it was there";
  EXPECT_EQ(
      messageOf([&] { marginals.covariance(c); }),
      "[slom.stale-marginals] the VarID<vect<2>> refers to a variable that was not in the problem when the "
      "marginals were computed; call marginals() again, of the estimator that holds it");
  EXPECT_NEAR(est.marginals().standardDeviation(c)[0], 0.3, 1e-12);
  slom::Estimator other;
  const auto foreign = insertMeasured(other, 1, "foreign");
  EXPECT_NE(messageOf([&] { marginals.covariance(foreign); }).find("[slom.stale-marginals]"),
            std::string::npos);
  EXPECT_EQ(messageOf([&] { marginals.covariance(slom::VarID<Point>()); }),
            "[slom.stale-handle] the VarID refers to no variable; assign it the result of insertRV first");
}

TEST(Marginals, OutliveTheirEstimator) {
  slom::Marginals marginals;
  slom::VarID<Point> id;
  {
    slom::Estimator est;
    id = insertMeasured(est, 0.5, "x");
    marginals = est.marginals();
  }
  EXPECT_NEAR(marginals.standardDeviation(id)[0], 0.5, 1e-12);
}

TEST(ParameterTable, OfAFreeNetworkShowsWhatStandardDeviationGives) {
  slom::Estimator est;
  est.setFreeGauge(slom::FreeGauge::inner_constraints);
  est.changeAlgorithm(slom::LevenbergMarquardt());
  const auto a = est.insertRV(Point(0, 0), "a");
  const auto b = est.insertRV(Point(3, 0.1), "b");
  const auto c = est.insertRV(Point(1, 4), "c");
  const auto difference = [](const auto& x, const auto& y) { return y - x; };
  est.insertMeasurement(difference, a, b, slom::measured(Point(3, 0)), slom::StandardDeviation(0.1));
  est.insertMeasurement(difference, b, c, slom::measured(Point(-2, 4)), slom::StandardDeviation(0.2));
  est.insertMeasurement(difference, a, c, slom::measured(Point(1.1, 4)), slom::StandardDeviation(0.3));
  const slom::Summary summary = est.optimize();
  ASSERT_TRUE(summary.converged) << summary;
  ASSERT_EQ(summary.parameters.size(), 6u);
  std::size_t next = 0;
  for (const auto& id : {a, b, c}) {
    for (const double deviation : est.standardDeviation(id)) {
      EXPECT_NEAR(summary.parameters[next].standard_deviation, deviation, 1e-12);
      EXPECT_GT(summary.parameters[next++].standard_deviation, 0.01);
    }
  }
  EXPECT_EQ(summary.parameters[3].name, "b.y");
}

}  // namespace
