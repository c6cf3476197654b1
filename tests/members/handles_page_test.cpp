// The code of docs/fitting.md, docs/handles.md and docs/manifolds.md, unchanged: handles, names, captures of functions,
// errors, exp and log.
#include <array>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <mtk/error.hpp>
#include <slom/slom.hpp>

namespace {

using Vec3 = mtk::vect<3>;
using Texts = std::vector<std::string>;

TEST(HandlesPage, ValuesAndNames) {
  slom::Estimator est;
  const auto tower = est.insertRV(Vec3(60, 80, 12), "tower");
  const auto unnamed = est.insertRV(Vec3(1, 2, 3));
  est.reinitRV(tower, Vec3(60, 81, 12));                             // another start
  const std::string name = est.nameOf(tower);                        // "tower"
  const std::vector<std::string> parts = est.componentNames(tower);  // "tower.x", "tower.y", "tower.z"
  est.fix(tower, "z");
  EXPECT_EQ((*tower)[1], 81);
  EXPECT_EQ(name, "tower");
  EXPECT_EQ(parts, (Texts{"tower.x", "tower.y", "tower.z"}));
  EXPECT_EQ(est.nameOf(unnamed).substr(est.nameOf(unnamed).size() - 3), " #2");  // the second variable
  EXPECT_EQ(est.getN(), 5);
}

TEST(HandlesPage, NumbersOfMeasurements) {
  slom::Estimator est;
  const std::vector<double> lengths{2.0, 2.1, 1.9, 2.0, 4.0, 2.05};
  const auto length = est.insertRV(2.0, "length");
  const auto datum = [](const auto& x) { return 1.0 * x; };
  est.insertMeasurement(datum, length, slom::measured(2.0), slom::StandardDeviation(0.1),
                        slom::named("plan"));
  for (const double tape : lengths)
    est.insertMeasurement(datum, length, slom::measured(tape), slom::StandardDeviation(0.1),
                          slom::named("tape"));
  est.optimize();
  const slom::OutlierReport report = slom::outliers(est);
  const slom::GroupCheck& tape = report.groups[1];
  EXPECT_EQ(tape.name, "tape");
  EXPECT_EQ(tape.worst[0].measurement, "tape #5");
  EXPECT_EQ(tape.worst[0].number, 5);
  EXPECT_EQ(report.groups[0].worst[0].number, 1);  // each label counts by itself
  std::vector<double> suspects;
  for (const slom::MeasurementCheck& check : report.groups[1].worst)
    if (check.is_suspect) suspects.push_back(lengths[std::size_t(check.number - 1)]);
  ASSERT_FALSE(suspects.empty());
  EXPECT_EQ(suspects.front(), 4.0);
}

TEST(HandlesPage, NumbersStayWhenOthersAreRemoved) {
  slom::Estimator est;
  const auto x = est.insertRV(0.0, "x");
  const auto same = [](const auto& v) { return 1.0 * v; };
  const auto insert = [&](double z) {
    return est.insertMeasurement(same, x, slom::measured(z), slom::StandardDeviation(1.0),
                                 slom::named("datum"));
  };
  const auto first = insert(0.0);
  for (const double z : {0.1, -0.1, 40.0}) insert(z);
  est.removeMeasurement(first);
  insert(0.05);
  est.optimize();
  const slom::GroupCheck group = slom::outliers(est).groups[0];
  EXPECT_EQ(group.worst[0].measurement, "datum #4");
  for (const slom::MeasurementCheck& check : group.worst) EXPECT_NE(check.measurement, "datum #1");
}

TEST(HandlesPage, WhatFunctionsKeep) {
  slom::Estimator est;
  const auto gain = est.insertRV(1.0, "gain");
  auto curve = std::make_shared<std::vector<double>>(std::vector<double>{0.0, 0.5, 2.0});
  est.insertMeasurement([curve](const auto& g, int i) { return g * curve->at(std::size_t(i)); }, gain, 2,
                        slom::measured(3.0), slom::StandardDeviation(0.1));
  EXPECT_EQ(curve.use_count(), 2);  // the measurement has a copy
  curve.reset();
  est.optimize();
  EXPECT_NEAR(*gain, 1.5, 1e-9);
}

TEST(HandlesPage, DataAreCopied) {
  slom::Estimator est;
  const auto gain = est.insertRV(1.0, "gain");
  double x = 2;
  est.insertMeasurement([](const auto& g, double at) { return g * at; }, gain, x, slom::measured(3.0));
  x = 1000;
  est.optimize();
  EXPECT_NEAR(*gain, 1.5, 1e-9);
}

TEST(HandlesPage, ErrorsAreExceptions) {
  slom::Estimator est;
  const auto gain = est.insertRV(1.0, "gain");
  std::string id, subject;
  try {
    est.covariance(gain);
  } catch (const mtk::Error& error) {
    id = error.id();            // "slom.unmeasured-variable"
    subject = error.subject();  // "gain"; error.what() has the whole message
  }
  EXPECT_EQ(id, "slom.unmeasured-variable");
  EXPECT_EQ(subject, "gain");
}

TEST(HandlesPage, ExpAndLog) {
  const mtk::SO3<> R = mtk::SO3<>::exp(Vec3(0, 0, 0.3));  // rotation vector: axis times angle [rad]
  const Vec3 v = mtk::SO3<>::log(R);                      // the shortest one, |v| <= pi
  mtk::SO3<> turned = R;
  turned.boxplus(Vec3(0.1, 0, 0));            // R exp(0.1, 0, 0)
  const Vec3 d = mtk::difference(turned, R);  // log(R^-1 turned)
  EXPECT_LT((v - Vec3(0, 0, 0.3)).norm(), 1e-15);
  EXPECT_LT((d - Vec3(0.1, 0, 0)).norm(), 1e-15);
  const mtk::SO3<> product = R * mtk::SO3<>::exp(Vec3(0.1, 0, 0));
  EXPECT_LT(mtk::difference(product, turned).norm(), 1e-15);
}

/// A joint of a robot: an axis in space.
template <class S>
struct AxisOf {
  mtk::S2<S> direction;
  mtk::vect<3, S> point;  ///< any one on the axis
};

TEST(HandlesPage, RotationAboutAnAxisThatIsEstimated) {
#ifdef __clang__
  GTEST_SKIP() << "clang numbers the members of plain structs";
#endif
  const AxisOf<double> truth{mtk::S2<>(0.1, -0.2, 1), Vec3(1, 2, 0)};
  const Vec3 tip(3, 1, 0.5);
  slom::Estimator est;
  const auto axis = est.insertRV(AxisOf<double>{mtk::S2<>(0, 0, 1), Vec3(0, 0, 0)}, "axis");
  est.fix(axis, "point.z");  // a point that slides along the axis changes nothing
  for (const double angle : {0.0, 0.4, 0.9, 1.5, 2.2}) {
    const mtk::SO3<> R = mtk::SO3<>::exp(Vec3(angle * truth.direction.vector()));
    const Vec3 seen = R * (tip - truth.point) + truth.point;
    est.insertMeasurement(
        [](const auto& axis, double angle, const Vec3& p) {
          const auto R = mtk::SO3<>::exp(angle * axis.direction.vector());
          return R * (p - axis.point) + axis.point;
        },
        axis, angle, tip, slom::measured(seen), slom::StandardDeviation(0.001), slom::named("tip"));
  }
  const slom::Summary summary = est.optimize();
  EXPECT_TRUE(summary.converged) << summary;
  EXPECT_LT(mtk::difference(axis->direction, truth.direction).norm(), 1e-8);
  EXPECT_LT((axis->point - truth.point).norm(), 1e-7);
  EXPECT_EQ(summary.groups[0].derivatives, "exact");
}

}  // namespace
