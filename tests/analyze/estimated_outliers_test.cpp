// Tests of residuals whose standard deviations come from the residuals: a wrong measurement does not hide itself.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include <mtk/testing/random.hpp>
#include <slom/analyze/student.hpp>
#include <slom/slom.hpp>

namespace {

using mtk::testing::Random;

constexpr auto straight = [](const auto& p, double at, double z) { return p[0] + p[1] * at - z; };

/// A line through the points at 0, 1, 2, ... One point is off.
struct EstimatedLine {
  slom::Estimator est;
  std::vector<slom::AnyMeasID> points;
  EstimatedLine(const std::vector<double>& z) {
    est.setThreads(1);
    est.setSigma(slom::Sigma::estimated);
    const auto p = est.insertRV(Eigen::Vector2d(0, 0), "line");
    for (std::size_t i = 0; i < z.size(); ++i)
      points.push_back(est.insertMeasurement(straight, p, double(i), z[i], slom::named("point")));
    est.optimize();
  }
};

std::vector<double> noisyLine(int count, Random& random) {
  std::vector<double> z;
  for (int i = 0; i < count; ++i) z.push_back(1 + 0.5 * i + 0.02 * random.normal());
  return z;
}

TEST(EstimatedOutliers, AnErrorOfAnySizeIsFoundInASmallProblem) {
  for (const double error : {0.5, 5.0, 1000.0, 1e9}) {
    Random random(5);
    std::vector<double> z = noisyLine(8, random);
    z[3] += error;
    const slom::OutlierReport report = slom::outliers(EstimatedLine(z).est);
    ASSERT_EQ(report.suspects(), 1) << report;
    EXPECT_EQ(report.ranking().front().measurement, "point #4");
  }
}

/// t^2 = (RSS - RSS without it) / (RSS without it / degrees of freedom without it).
TEST(EstimatedOutliers, AreTestedAgainstTheFitWithoutThem) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Random random(seed);
    std::vector<double> z = noisyLine(7, random);
    z[seed % 7] += 0.05;
    EstimatedLine all(z);
    const double rss = all.est.getRSS();
    const slom::OutlierReport report = slom::outliers(all.est);
    for (const slom::MeasurementCheck& check : report.groups[0].worst) {
      EstimatedLine rest(z);
      rest.est.removeMeasurement(rest.points[std::size_t(check.number - 1)]);
      rest.est.optimize();
      const double t2 = (rss - rest.est.getRSS()) / (rest.est.getRSS() / 4);
      EXPECT_NEAR(check.studentized * check.studentized, t2, 1e-8 * t2 + 1e-9);
      EXPECT_NEAR(check.probability, slom::studentProbability(std::sqrt(t2), 4), 1e-9);
    }
  }
}

TEST(EstimatedOutliers, GoodDataHaveAsManyAsStated) {
  constexpr int fits = 2000;
  int alarms = 0;
  Random random(11);
  for (int k = 0; k < fits; ++k)
    alarms += slom::outliers(EstimatedLine(noisyLine(6, random)).est, {.significance = 0.05}).suspects() > 0;
  EXPECT_NEAR(alarms, 0.05 * fits, 4 * std::sqrt(0.05 * fits));
}

TEST(EstimatedOutliers, SayWhichStandardDeviationsCount) {
  Random random(3);
  EstimatedLine all(noisyLine(9, random));
  slom::OutlierReport report = slom::outliers(all.est);
  EXPECT_EQ(report.text().find("standard deviations are estimated from the residuals: "), 0u) << report;
  EXPECT_EQ(report.groups[0].probability, 1) << "the group cannot contradict what it gave";
  EXPECT_TRUE(std::ranges::none_of(slom::diagnose(all.est).findings, [](const slom::Finding& finding) {
    return finding.kind == slom::Finding::Kind::implausible_sigma;
  }));
  all.est.setSigma(slom::Sigma::known);
  report = slom::outliers(all.est);
  EXPECT_EQ(report.text().find("no standard deviation was stated, 1 is assumed"), 0u) << report;
}

}  // namespace
