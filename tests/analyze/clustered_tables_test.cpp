// Clustered covariances in other reports: tests of groups, the summary's table, profile intervals.
#include <cmath>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <slom/analyze/chi_square.hpp>
#include <slom/analyze/clustered.hpp>
#include <slom/slom.hpp>

#include "support/message_of.hpp"

namespace {

using Eigen::VectorXd;
using slom::testing::messageOf;
using vec2 = mtk::vect<2>;

/// A line, measured in groups of five with a shared error.
struct GroupedLine {
  slom::Estimator est;
  slom::VarID<vec2> line = est.insertRV(vec2(0, 0), "line");

  GroupedLine(unsigned seed, double shared, double blunder = 0, int groups = 12) {
    std::mt19937 engine(seed);
    std::normal_distribution<double> normal;
    for (int g = 0; g < groups; ++g) {
      const double common = shared * normal(engine) + (g == 4 ? blunder : 0);
      for (int i = 0; i < 5; ++i) {
        const double t = normal(engine);
        est.insertMeasurement([](const auto& x, double at) { return x[0] + at * x[1]; }, line, t,
                              slom::measured(1 + 2 * t + common + normal(engine)), slom::group("day", g));
      }
    }
    EXPECT_TRUE(est.optimize().converged);
  }
};

TEST(ClusterOutliers, NameTheGroupThatPullsMoreThanOthers) {
  GroupedLine good(1, 0, 0, 40), bad(1, 0, 6, 40), shared(1, 2, 0, 40), shared_bad(1, 2, 40, 40);
  EXPECT_EQ(slom::clustered(good.est).outliers().suspects(), 0);
  const slom::ClusterOutliers found = slom::clustered(bad.est).outliers();
  EXPECT_EQ(found.suspects(), 1);
  EXPECT_EQ(found.groups[0].check.group, "day 4");
  // Where all share errors, each alone is improbable as stated; among the others none is.
  const slom::ClusterOutliers all = slom::clustered(shared.est).outliers();
  EXPECT_EQ(all.suspects(), 0);
  EXPECT_GT(all.scale, 2);
  EXPECT_LT(all.groups[0].check.probability, 1e-3);
  const slom::ClusterOutliers one = slom::clustered(shared_bad.est).outliers();
  EXPECT_EQ(one.suspects(), 1);
  EXPECT_EQ(one.groups[0].check.group, "day 4");
  EXPECT_TRUE(one.is_relative);
  EXPECT_FALSE(found.is_relative);
  EXPECT_EQ(found.groups[0].probability, found.groups[0].check.probability);
}

/// With the significance 0.05 at most about one problem in twenty has a suspect.
TEST(ClusterOutliers, FalseAlarms) {
  int independent = 0, shared = 0;
  for (unsigned seed = 0; seed < 400; ++seed) {
    GroupedLine a(1000 + seed, 0, 0, 30), b(5000 + seed, 2, 0, 30);
    independent += slom::clustered(a.est).outliers(0.05).suspects() > 0 ? 1 : 0;
    shared += slom::clustered(b.est).outliers(0.05).suspects() > 0 ? 1 : 0;
  }
  EXPECT_LE(independent, 32);  // 20 expected
  EXPECT_GE(independent, 2);
  EXPECT_LE(shared, 32);
}

TEST(ClusterOutliers, Text) {
  GroupedLine bad(1, 0, 6, 3);
  std::ostringstream text;
  text << slom::clustered(bad.est).outliers();
  EXPECT_EQ(text.str(),
            "3 groups, 0 suspects; half of them pull at the values at least 0.933 times as much as stated "
            "uncertainties predict\n"
            "  group                    measurements  statistic   dof   as stated    probability\n"
            "  day 2                               5      1.485     2        0.48           0.48\n"
            "  day 1                               5      1.207     2        0.55           0.55\n"
            "  day 0                               5     0.4255     2        0.81           0.81\n");
  EXPECT_EQ(
      messageOf([&] { slom::clustered(bad.est).outliers(0); }),
      "[slom.bad-option] the significance of tests of groups is 0; pass a probability between 0 and 1, such as 0.01");
}

TEST(ClusteredColumn, OfASummary) {
  GroupedLine fit(2, 1);
  const slom::Summary before = fit.est.optimize();
  slom::Summary after = before;
  const slom::Clustered c = slom::clustered(fit.est);
  c.addTo(after);
  EXPECT_EQ(after.parameters[1].clustered, c.standardDeviation(fit.line)[1]);
  EXPECT_EQ(after.parameters[1].clustered_dof, c.degreesOfFreedom(fit.line)[1]);
  EXPECT_EQ(after.clustered_notes, c.notes(fit.line));
  EXPECT_EQ(after.report().substr(after.report().find("  parameter")),
            "  parameter          value   standard deviation    clustered      dof\n"
            "  line.x         1.1388535                0.129        0.139       11\n"
            "  line.y         1.8376914                0.121        0.129     7.53\n");
  EXPECT_EQ(before.report().find("clustered"), std::string::npos);
  slom::Summary none = fit.est.optimize({.most_parameters = 1});
  EXPECT_EQ(messageOf([&] { slom::clustered(fit.est).addTo(none); }),
            "[slom.no-parameters] the summary has no table of the parameters of these covariances; take the "
            "summary of "
            "the last fit, with Options::most_parameters not below the number of unknowns");
}

TEST(ClusteredProfile, IsTheIntervalWhereTheRssIsQuadratic) {
  for (const slom::Sigma sigma : {slom::Sigma::known, slom::Sigma::estimated}) {
    GroupedLine fit(3, 2);
    fit.est.setSigma(sigma);
    const VectorXd half = slom::clustered(fit.est).interval(fit.line, 0.9);
    const slom::ProfileInterval x = slom::profile(fit.est, fit.line, "x", slom::clustered(fit.est), 0.9);
    EXPECT_NEAR(x.upper - x.value, half[0], 1e-5 * half[0]);
    EXPECT_NEAR(x.value - x.lower, half[0], 1e-5 * half[0]);
    EXPECT_GT(half[0], 1.5 * (slom::profile(fit.est, fit.line, "x", 0.9).upper - x.value));
  }
}

/// A rate that is measured only through its logarithm. The interval is asymmetric, with the ends of the logarithm's
/// interval.
TEST(ClusteredProfile, KeepsTheShapeOfTheRss) {
  slom::Estimator est;
  const auto rate = est.insertRV(1.5, "rate");
  std::mt19937 engine(5);
  std::normal_distribution<double> normal(0, 0.2);
  for (int g = 0; g < 10; ++g) {
    const double common = 3 * normal(engine);
    for (int i = 0; i < 4; ++i)
      est.insertMeasurement(
          [](const auto& x) {
            using std::log;
            return log(x);
          },
          rate, slom::measured(0.5 + common + normal(engine)), slom::StandardDeviation(0.2), slom::group(g));
  }
  ASSERT_TRUE(est.optimize().converged);
  const double half = slom::clustered(est).interval(rate)[0] / *rate;  // of the logarithm
  const slom::ProfileInterval interval = slom::profile(est, rate, "", slom::clustered(est));
  EXPECT_NEAR(std::log(interval.upper / *rate), half, 1e-4 * half);
  EXPECT_NEAR(std::log(*rate / interval.lower), half, 1e-4 * half);
}

TEST(ClusteredProfile, Errors) {
  GroupedLine fit(3, 2), other(4, 2);
  const slom::Clustered c = slom::clustered(fit.est);
  EXPECT_EQ(messageOf([&] { slom::profile(other.est, other.line, "x", c); }),
            "[slom.stale-clustered] the clustered covariances belong to another estimator; pass "
            "slom::clustered(est) of this one");
  EXPECT_EQ(
      messageOf([&] { slom::profile(fit.est, fit.line, "x", c, 1.5); }),
      "[slom.bad-option] the probability of a profile interval is 1.5; pass one between 0 and 1, such as 0.95");
  const double x = (*fit.line)[0];
  slom::profile(fit.est, fit.line, "x", c);
  EXPECT_EQ((*fit.line)[0], x);
  EXPECT_EQ(
      messageOf([&] { slom::profile(fit.est, fit.line, "x", c); }),
      "[slom.stale-clustered] the clustered covariances belong to a fit that has changed or is gone; call "
      "slom::clustered(est) again");
  fit.est.reinitRV(fit.line, vec2(x - 0.6, 0));
  fit.est.bound(fit.line, "x", x - 1, x - 0.5);
  ASSERT_TRUE(fit.est.optimize().converged);
  EXPECT_EQ(
      messageOf([&] { slom::profile(fit.est, fit.line, "x", slom::clustered(fit.est)); }),
      "[slom.no-clustered-deviation] line.x has no clustered standard deviation, because it is at its bound "
      "or all residuals are 0; take the profile without clustered covariances");
}

}  // namespace
