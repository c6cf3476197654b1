// Outliers over all kinds of measurements, poorly checkable measurements, and handles to measurements of any type.
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <slom/slom.hpp>

#include "support/message_of.hpp"

namespace {

using slom::AnyMeasID;
using slom::testing::messageOf;
using vec2 = mtk::vect<2>;

const auto lengthOf = [](const auto& a, const auto& b) { return (a - b).norm(); };
const auto positionOf = [](const auto& a) { return a; };

/// Points in the plane, positions of some of them, and distances. One point depends on a single position and a single
/// distance.
struct CheckedSurvey {
  slom::Estimator est;
  std::vector<slom::VarID<vec2>> points;
  std::vector<AnyMeasID> all;

  explicit CheckedSurvey(unsigned seed) {
    std::mt19937 engine(seed);
    std::normal_distribution<double> noise(0, 0.01);
    const std::vector<vec2> truth{{0, 0}, {100, 5}, {90, 80}, {-10, 70}, {40, 30}, {300, 200}};
    for (std::size_t i = 0; i < truth.size(); ++i)
      points.push_back(est.insertRV(truth[i], "p" + std::to_string(i)));
    for (std::size_t i = 0; i < truth.size(); ++i) {
      all.push_back(est.insertMeasurement(positionOf, points[i],
                                          slom::measured(vec2(truth[i] + vec2(noise(engine), noise(engine)))),
                                          slom::StandardDeviation(0.01), slom::named("position")));
    }
    for (std::size_t i = 0; i < 5; ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        all.push_back(est.insertMeasurement(lengthOf, points[i], points[j],
                                            slom::measured((truth[i] - truth[j]).norm() + noise(engine)),
                                            slom::StandardDeviation(0.01), slom::named("distance")));
      }
    }
    est.optimize();
  }
};

TEST(Ranking, GoesOverAllKindsAndItsRowsCanBeRemoved) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    CheckedSurvey survey(seed);
    // Gross errors of two kinds.
    const auto wrong_distance =
        survey.est.insertMeasurement(lengthOf, survey.points[0], survey.points[2], slom::measured(120.9),
                                     slom::StandardDeviation(0.01), slom::named("distance"));
    const auto wrong_position =
        survey.est.insertMeasurement(positionOf, survey.points[4], slom::measured(vec2(41, 30)),
                                     slom::StandardDeviation(0.01), slom::named("position"));
    ASSERT_TRUE(survey.est.optimize().converged);
    // One after the other, the worst first.
    std::vector<AnyMeasID> removed;
    for (int round = 0; round < 2; ++round) {
      const std::vector<slom::MeasurementCheck> ranking = slom::outliers(survey.est).ranking();
      EXPECT_TRUE(std::ranges::is_sorted(ranking, {}, &slom::MeasurementCheck::probability));
      EXPECT_EQ(survey.est.nameOf(ranking.front().id), ranking.front().measurement);
      EXPECT_NEAR(survey.est.whitenedResidual(ranking.front().id).norm(), ranking.front().residual, 1e-12);
      removed.push_back(ranking.front().id);
      survey.est.removeMeasurement(ranking.front().id);
      ASSERT_TRUE(survey.est.optimize().converged);
    }
    EXPECT_TRUE(std::ranges::find(removed, AnyMeasID(wrong_distance)) != removed.end());
    EXPECT_TRUE(std::ranges::find(removed, AnyMeasID(wrong_position)) != removed.end());
    EXPECT_FALSE(wrong_distance.isValid());
  }
}

TEST(Ranking, NamesWhatNothingChecks) {
  CheckedSurvey survey(1);
  const slom::OutlierReport report = slom::outliers(survey.est);
  // Only the position of the last point has no other measurement that checks it.
  ASSERT_EQ(report.hardlyCheckable(), 1);
  const slom::GroupCheck& positions = report.groups.front();
  ASSERT_EQ(positions.least_checkable.size(), 1u);
  EXPECT_EQ(positions.least_checkable[0].measurement, "position #6");
  EXPECT_TRUE(positions.least_checkable[0].isHardlyCheckable());
  const std::string text = report.text();
  EXPECT_NE(text.find("ranking over all measurements\n"), std::string::npos) << text;
  EXPECT_NE(
      text.find(
          "hardly checkable, with a redundancy below 0.1: position #6 (0); an error in it hardly shows in the "
          "residuals, so measure the same in another way\n"),
      std::string::npos)
      << text;
  // The oracle of redundancy: how much of an error in a measurement shows in its own residual.
  for (const AnyMeasID& id : survey.all) {
    const Eigen::VectorXd r = survey.est.whitenedResidual(id);
    EXPECT_EQ(survey.est.weight(id), 1);
    EXPECT_DOUBLE_EQ(survey.est.getRSS(id), r.squaredNorm());
  }
}

TEST(AnyMeasID, IsAHandleLikeTheOneItWasMadeOf) {
  slom::Estimator est;
  const auto x = est.insertRV(1.0, "x");
  const auto first = est.insertMeasurement([](const auto& a) { return a - 1.0; }, x, slom::named("one"));
  const auto second =
      est.insertMeasurement([](const auto& a) { return 2.0 * a; }, x, slom::StandardDeviation(0.5));
  AnyMeasID any = first;
  EXPECT_TRUE(any == AnyMeasID(first));
  EXPECT_FALSE(any == AnyMeasID(second));
  EXPECT_EQ(est.nameOf(any), "one #1");
  any = second;
  EXPECT_EQ(est.whitenedResidual(any)[0], 4);
  EXPECT_EQ(est.residual(second)[0], 2);
  const slom::Estimator copy = est.clone();
  EXPECT_EQ(copy.whitenedResidual(copy.own(any))[0], 4);
  est.setGroup(any, slom::group("day", 3));
  est.removeMeasurement(any);
  EXPECT_FALSE(any.isValid());
  EXPECT_EQ(messageOf([&] { (void)est.residual(any); }).substr(0, 19), "[slom.stale-handle]");
  EXPECT_EQ(messageOf([&] { (void)est.nameOf(AnyMeasID()); }).substr(0, 19), "[slom.stale-handle]");
  EXPECT_EQ(est.getM(), 1);
}

TEST(Bound, OfAVectorHoldsForAllOfIt) {
  slom::Estimator est;
  const auto x = est.insertRV(mtk::vect<3>(0.5, 0.5, 0.5), "x");
  est.bound(x, 0, 1);
  est.insertMeasurement([](const auto& a) { return a; }, x, slom::measured(mtk::vect<3>(-3, 0.25, 7)));
  const slom::Summary summary = est.optimize();
  EXPECT_TRUE(summary.converged);
  EXPECT_EQ(*x, mtk::vect<3>(0, 0.25, 1));
  EXPECT_EQ(summary.active_bounds.size(), 2u);
  const auto pose = est.insertRV(mtk::trafo<mtk::SO3<>>(), "pose");
  EXPECT_EQ(messageOf([&] { est.bound(pose, -1, 1); }).substr(0, 16), "[slom.bad-bound]");
}

}  // namespace
