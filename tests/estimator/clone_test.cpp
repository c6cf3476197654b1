// Copies of estimators: they share only captures with the original, and accept its handles.
#include <cmath>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <slom/analyze/clustered.hpp>
#include <slom/measurements.hpp>
#include <slom/posterior.hpp>
#include <slom/slom.hpp>
#include <slom/solve/block_qr.hpp>

#include "support/message_of.hpp"

namespace {

using slom::testing::messageOf;
using SE2 = mtk::trafo<mtk::SO2<>>;
using vec2 = mtk::vect<2>;

const auto seen = [](const auto& T, const auto& p) { return T.inverse() * p; };

/// Poses that see points, one datum wrong; everything that an estimator can hold.
struct Map {
  slom::Estimator est;
  std::vector<slom::VarID<SE2>> poses;
  std::vector<slom::VarID<vec2>> points;
  using Sight = decltype(std::declval<slom::Estimator&>().insertMeasurement(
      seen, std::declval<slom::VarID<SE2>>(), std::declval<slom::VarID<vec2>>(), slom::measured(vec2())));
  std::vector<Sight> sights;

  Map() {
    std::mt19937 engine(11);
    std::normal_distribution<double> normal(0, 0.05);
    for (int i = 0; i < 5; ++i) poses.push_back(est.insertRV(SE2(mtk::SO2<>(0.1 * i), vec2(i, 0)), i > 0));
    for (int i = 0; i < 12; ++i)
      points.push_back(est.insertRV(vec2(i % 4, 2 + i / 4), "point " + std::to_string(i)));
    int number = 0;
    for (const auto& pose : poses) {
      for (const auto& point : points) {
        vec2 z = seen(*pose, *point) + vec2(normal(engine), normal(engine));
        if (++number == 17) z += vec2(5, -4);
        sights.push_back(est.insertMeasurement(seen, pose, point, slom::measured(z),
                                               slom::StandardDeviation(vec2(0.05, 0.06)), slom::Cauchy(2.5),
                                               slom::named("sight"), slom::group(number / 12)));
      }
    }
    est.fix(points[0], "x");
    est.reinitRV(points[1], vec2(1, 1.9));
    est.bound(points[1], "y", 1.8, 1.95);
    est.insertMeasurement([](std::span<const slom::VariableView> x,
                             double z) { return x[0].as<vec2>().norm() + x[1].as<vec2>().norm() - z; },
                          {points[2], points[3]}, 6.5, slom::StandardDeviation(0.1));
    est.removeMeasurement(sights[3]);
    est.removeMeasurement(sights[40]);
    const auto gone = est.insertRV(vec2(), "gone");
    est.removeRV(gone);
  }
};

void expectSameFit(const slom::Summary& a, const slom::Summary& b) {
  EXPECT_EQ(a.final_rss, b.final_rss);
  EXPECT_EQ(a.iterations, b.iterations);
  EXPECT_EQ(a.unknowns, b.unknowns);
  EXPECT_EQ(a.active_bounds, b.active_bounds);
  ASSERT_EQ(a.groups.size(), b.groups.size());
  for (std::size_t g = 0; g < a.groups.size(); ++g) {
    EXPECT_EQ(a.groups[g].name, b.groups[g].name);
    EXPECT_EQ(a.groups[g].final_rss, b.groups[g].final_rss);
    EXPECT_EQ(a.groups[g].losses.size(), b.groups[g].losses.size());
  }
}

TEST(Clone, FitsAsTheOriginalWouldAndLeavesItAlone) {
  Map map;
  const Eigen::VectorXd start = map.est.residuals();
  slom::Estimator copy = map.est.clone();
  EXPECT_EQ(copy.residuals(), start);
  const slom::Summary of_copy = copy.optimize();
  EXPECT_TRUE(of_copy.converged) << of_copy;
  EXPECT_LT(of_copy.final_rss, of_copy.initial_rss);
  EXPECT_EQ(map.est.residuals(), start) << "the original has not moved";
  const slom::Summary of_original = map.est.optimize();
  expectSameFit(of_copy, of_original);
  EXPECT_EQ(of_copy.active_bounds.size(), 1u);
  for (const auto& id : map.points) {
    EXPECT_EQ(*copy.own(id), *id);
    EXPECT_EQ(copy.nameOf(id), map.est.nameOf(id));
    EXPECT_EQ(copy.covariance(id), map.est.covariance(id));
  }
  EXPECT_EQ(copy.jointCovariance(map.poses[1], map.points[4]),
            map.est.jointCovariance(map.poses[1], map.points[4]));
  EXPECT_EQ(slom::clustered(copy).standardDeviation(map.points[5]),
            slom::clustered(map.est).standardDeviation(map.points[5]));
  EXPECT_EQ(copy.weight(map.sights[16]), map.est.weight(map.sights[16]));
  EXPECT_LT(copy.weight(map.sights[16]), 0.1);
}

TEST(Clone, IsIndependent) {
  Map map;
  const double rss = map.est.getRSS();
  slom::Estimator copy = map.est.clone();
  copy.removeMeasurement(map.sights[7]);
  copy.reinitRV(map.points[4], vec2(100, 100));
  copy.fix(map.poses[2]);
  copy.free(map.points[0], "x");
  copy.setSigma(slom::Sigma::estimated);
  EXPECT_EQ(map.est.getRSS(), rss);
  EXPECT_EQ(*map.points[4], vec2(0, 3));
  EXPECT_EQ(*copy.own(map.points[4]), vec2(100, 100));
  EXPECT_TRUE(map.sights[7].isValid());
  EXPECT_EQ(map.est.getM(), copy.getM() + 2);
  EXPECT_EQ(map.est.getN(), copy.getN() + 3 - 1);
  EXPECT_EQ(map.est.sigma(), slom::Sigma::known);
  const double of_copy = copy.getRSS();
  map.est.optimize();
  EXPECT_EQ(copy.getRSS(), of_copy);
}

TEST(Clone, TakesHandlesOfTheOriginalEverywhere) {
  Map map;
  slom::Estimator copy = map.est.clone();
  const auto point = map.points[4];
  copy.reinitRV(point, vec2(7, 8));
  // What is evaluated is the copy, though *point reads the original.
  const auto x = copy.insertMeasurement([](const auto& p) { return p[0]; }, point, slom::measured(1.0));
  EXPECT_EQ(copy.residual(x)[0], 6);
  const auto list = copy.insertMeasurement(
      [](std::span<const slom::VariableView> v) { return v[0].as<vec2>()[1]; }, {point});
  EXPECT_EQ(copy.residual(list)[0], 8);
  const auto known = copy.prior(point, "y", 1, 0.5);
  EXPECT_EQ(copy.residual(known)[0], 7);
  copy.optimize();
  EXPECT_LT(copy.residual(x).norm(), 6) << "the fit moves what the measurement depends on";
  EXPECT_EQ(copy.getRSS(point), copy.getRSS(copy.own(point)));
  EXPECT_EQ(copy.standardDeviation(point), copy.standardDeviation(copy.own(point)));
  EXPECT_EQ(copy.correlation(point, map.poses[1]), copy.correlation(copy.own(point), copy.own(map.poses[1])));
  EXPECT_EQ(copy.componentNames(point), map.est.componentNames(point));
  const auto twice = copy.propagate([](const auto& p) { return 2.0 * p[0]; }, point);
  EXPECT_EQ(twice.value, 2 * (*copy.own(point))[0]);
  const auto [after, ids] = slom::posterior(copy, point);
  EXPECT_EQ(*std::get<0>(ids), *copy.own(point));
  copy.setGroup(map.sights[0], slom::group(99));
  EXPECT_TRUE(slom::profile(copy, point, "x").lower < (*copy.own(point))[0]);
  copy.removeMeasurement(map.sights[0]);
  EXPECT_TRUE(map.sights[0].isValid());
  EXPECT_FALSE(map.est.own(map.sights[0]) == copy.own(map.sights[1]));
  for (const auto& id : map.sights) {
    if (id.isValid() && !(id == map.sights[0])) copy.removeMeasurement(id);
  }
  copy.removeMeasurement(x);
  copy.removeMeasurement(list);
  copy.removeMeasurement(known);
  copy.removeRV(point);
  EXPECT_EQ(*point, vec2(0, 3));
}

TEST(Clone, RefusesHandlesThatTheOriginalGotLater) {
  Map map;
  slom::Estimator copy = map.est.clone();
  const auto later = map.est.insertRV(vec2(1, 1), "later");
  const auto own = copy.insertRV(vec2(2, 2), "own");  // in the same slot
  const std::string foreign =
      "[slom.foreign-handle] the VarID<vect<2>> belongs to another estimator; use it only with the estimator whose "
      "insertRV returned it";
  EXPECT_EQ(messageOf([&] { copy.nameOf(later); }), foreign);
  EXPECT_EQ(messageOf([&] { map.est.nameOf(own); }), foreign);
  EXPECT_EQ(messageOf([&] { map.est.nameOf(copy.own(map.points[0])); }), foreign)
      << "not the other way round";
  const auto sight =
      map.est.insertMeasurement(seen, map.poses[0], later, slom::measured(vec2()), slom::named("sight"));
  copy.insertMeasurement(seen, map.poses[0], own, slom::measured(vec2()), slom::named("sight"));
  EXPECT_EQ(
      messageOf([&] { copy.residual(sight); }),
      "[slom.foreign-handle] the MeasID belongs to another estimator; use it only with the estimator whose "
      "insertMeasurement returned it");
}

TEST(Clone, KnowsWhatItHasRemovedItself) {
  Map map;
  slom::Estimator copy = map.est.clone();
  const auto lonely = map.est.insertRV(1.0);
  slom::Estimator other = map.est.clone();
  other.removeRV(lonely);
  other.insertRV(2.0);  // in its slot
  EXPECT_EQ(
      messageOf([&] { other.nameOf(lonely); }),
      "[slom.stale-handle] the VarID<double> refers to a variable that has been removed; keep the VarID that "
      "insertRV returned last");
  copy.removeMeasurement(map.sights[7]);
  EXPECT_EQ(
      messageOf([&] { copy.removeMeasurement(map.sights[7]); }),
      "[slom.stale-handle] the MeasID<sight> refers to a measurement that has been removed; keep the MeasID that "
      "insertMeasurement returned last");
  EXPECT_EQ(
      messageOf([&] { copy.getRSS(map.sights[3]); }),
      "[slom.foreign-handle] the MeasID belongs to another estimator; use it only with the estimator whose "
      "insertMeasurement returned it")
      << "removed before the copy was made";
}

TEST(Clone, OfACloneTakesTheHandlesOfBoth) {
  std::optional<Map> map(std::in_place);
  const auto point = map->points[4];
  const auto sight = map->sights[9];
  const double rss = map->est.getRSS(sight);
  slom::Estimator est = map->est.clone();
  const auto second = est.insertRV(3.0, "second");
  map.reset();
  for (int i = 0; i < 3; ++i) est = est.clone();
  EXPECT_EQ(est.nameOf(point), "point 4");
  EXPECT_EQ(est.nameOf(second), "second");
  EXPECT_EQ(est.getRSS(sight), rss);
  EXPECT_EQ(*est.own(second), 3);
  est.prior(second, 4, 1);
  EXPECT_TRUE(est.optimize().converged);
}

struct Range {
  double operator()(double x) const { return x; }
};

TEST(Clone, NumbersGoOn) {
  slom::Estimator est;
  const auto x = est.insertRV(1.0);
  est.insertMeasurement(Range(), x);
  slom::Estimator copy = est.clone();
  EXPECT_EQ(copy.nameOf(copy.insertRV(1.0)), "double #2");
  EXPECT_EQ(
      messageOf([&] { copy.insertMeasurement(Range(), x, slom::StandardDeviation(-1)); }),
      "[slom.not-positive-definite] standard deviation of measurement Range #2 is -1; pass positive finite "
      "numbers");
}

TEST(Clone, HasMarginalPriorsAndTheirFirstEstimates) {
  Map map;
  map.est.optimize();
  map.est.marginalize({map.poses[1], map.points[2]}, {.first_estimates = true});
  map.est.reinitRV(map.poses[2], *map.poses[2] * SE2(mtk::SO2<>(0.1), vec2(0.1, 0)));
  std::optional<slom::Estimator> copy(map.est.clone());
  EXPECT_FALSE(copy->table().firstEstimates().isEmpty());
  slom::Estimator again = copy->clone();
  copy.reset();
  const slom::Summary a = again.optimize(), b = map.est.optimize();
  expectSameFit(a, b);
  EXPECT_EQ(mtk::difference(*again.own(map.poses[3]), *map.poses[3]).norm(), 0);
}

TEST(Clone, FollowsItsProblemByItself) {
  Map map;
  map.est.update();
  slom::Estimator copy = map.est.clone();
  const auto added = copy.insertRV(vec2(1, 1), "added");
  copy.insertMeasurement(seen, map.poses[4], added, slom::measured(vec2(1, 2)), slom::StandardDeviation(0.1));
  EXPECT_TRUE(copy.update().converged);
  const vec2 by_update = *added;
  copy.optimize();
  EXPECT_LT((by_update - *added).norm(), 1e-6);
}

TEST(Clone, SharesWhatFunctionsReferTo) {
  slom::Estimator est;
  const auto x = est.insertRV(1.0);
  double referred = 1;
  const auto shared = std::make_shared<double>(1);
  const double copied = 1;
  est.insertMeasurement([&referred, shared, copied](double v) { return v - referred - *shared - copied; }, x);
  const slom::Estimator copy = est.clone();
  referred = 10;
  *shared = 100;
  EXPECT_EQ(copy.getRSS(), 110.0 * 110.0);
}

TEST(Clone, KeepsSolverAlgorithmAndSettings) {
  Map map;
  map.est.changeSolver(std::make_unique<slom::BlockQR>(1e-7));
  map.est.changeAlgorithm(slom::LevenbergMarquardt(0.5));
  map.est.setSigma(slom::Sigma::estimated);
  map.est.setFreeGauge(slom::FreeGauge::inner_constraints);
  map.est.setThreads(1);
  slom::Estimator copy = map.est.clone();
  EXPECT_EQ(copy.sigma(), slom::Sigma::estimated);
  EXPECT_EQ(copy.freeGauge(), slom::FreeGauge::inner_constraints);
  const slom::Summary of_copy = copy.optimize(), of_original = map.est.optimize();
  EXPECT_EQ(of_copy.algorithm, "Levenberg-Marquardt");
  EXPECT_EQ(of_copy.solver, of_original.solver);
  EXPECT_NE(of_copy.solver.find("QR"), std::string::npos);
  EXPECT_EQ(of_copy.trace[1].damping, 0.5);
  expectSameFit(of_copy, of_original);
}

/// The state that Levenberg-Marquardt has learnt is copied too.
TEST(Clone, GoesOnStepByStep) {
  Map map;
  map.est.changeAlgorithm(slom::LevenbergMarquardt(0.5));
  for (int i = 0; i < 2; ++i) map.est.optimizeStep();
  slom::Estimator copy = map.est.clone();
  for (int i = 0; i < 2; ++i) {
    const slom::StepRecord a = map.est.optimizeStep(), b = copy.optimizeStep();
    EXPECT_EQ(a.rss_after, b.rss_after);
    EXPECT_EQ(a.damping, b.damping);
  }
}

class NotAnother final : public slom::ForwardingSolver {
 public:
  NotAnother() : ForwardingSolver(std::make_unique<slom::DenseQR>()) {}
  std::string description() const override { return "of a user"; }
};

TEST(Clone, SaysWhatCannotBeCopied) {
  slom::Estimator est;
  const auto x = est.insertRV(1.0);
  const auto id = est.insertMeasurement([own = std::make_unique<double>(1)](double v) { return v - *own; }, x,
                                        slom::named("range"));
  EXPECT_EQ(
      messageOf([&] { est.clone(); }),
      "[slom.not-copyable] measurement range #1 cannot be copied, because its function or its data cannot be "
      "copied; pass what they own as a shared_ptr, or insert the measurements anew into another estimator");
  est.removeMeasurement(id);
  est.changeSolver(std::make_unique<NotAnother>());
  EXPECT_EQ(
      messageOf([&] { est.clone(); }),
      "[slom.not-copyable] the solver of a user cannot be copied; implement its makeAnother(), or change to one of "
      "the library before clone()");
  slom::Estimator moved = std::move(est);
  EXPECT_EQ(messageOf([&] { est.clone(); }).substr(0, 17), "[slom.moved-from]");
}

}  // namespace
