// Fits without each group, by ClusterOptions::refit, against fits of problems that never had the group.
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <slom/analyze/clustered.hpp>
#include <slom/slom.hpp>

#include "support/message_of.hpp"

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using slom::testing::messageOf;
using vec2 = mtk::vect<2>;

/// Distances to towers, with another zero point on each day.
struct OffsetRange {
  auto operator()(const auto& place, const auto& offset, const vec2& tower) const {
    return (place - tower).norm() + offset;
  }
};

struct Ranging {
  slom::Estimator est;
  slom::VarID<vec2> place = est.insertRV(vec2(3, 4), "place");
  std::vector<slom::VarID<double>> offsets;
};

/// Inserts six days of ranges, far from linear, because towers are near. `left_out`: a day that is not inserted.
void range(Ranging& all, int left_out = -1, bool has_losses = false, bool has_last_tower = true) {
  std::mt19937 engine(2);
  std::normal_distribution<double> normal;
  const vec2 towers[] = {vec2(0, 0), vec2(6, 0), vec2(1, 7), vec2(5, 5)};
  for (int day = 0; day < 6; ++day) {
    const double offset = 0.3 * normal(engine);
    slom::VarID<double> own;
    if (day != left_out) {
      own = all.est.insertRV(0.0, "offset");
      all.offsets.push_back(own);
    }
    for (const vec2& tower : towers) {
      const double z =
          (vec2(2.5, 3.5) - tower).norm() + offset + 0.5 * normal(engine) + (day == 2 ? tower[0] : 0);
      if (day == left_out || (!has_last_tower && tower[0] == 5 && day > 0)) continue;
      if (has_losses) {
        all.est.insertMeasurement(OffsetRange(), all.place, own, tower, slom::measured(z),
                                  slom::StandardDeviation(0.5), slom::Huber(1.0), slom::group("day", day));
      } else {
        all.est.insertMeasurement(OffsetRange(), all.place, own, tower, slom::measured(z),
                                  slom::StandardDeviation(0.5), slom::group("day", day));
      }
    }
  }
  ASSERT_TRUE(all.est.optimize().converged);
}

TEST(ClusteredRefit, IsTheFitOfAProblemWithoutTheGroup) {
  for (const bool has_losses : {false, true}) {
    Ranging all;
    range(all, -1, has_losses);
    const slom::Clustered step = slom::clustered(all.est, {.by = {"day"}}),
                          fits = slom::clustered(all.est, {.by = {"day"}, .refit = true});
    const MatrixXd place = fits.change(all.place), offset = fits.change(all.offsets[3]);
    double largest = 0;
    for (int day = 0; day < 6; ++day) {
      Ranging without;
      range(without, day, has_losses);
      const VectorXd moved = *without.place - *all.place;
      EXPECT_LT((place.row(day).transpose() - moved).norm(), 1e-6) << day;
      if (day != 3) {
        EXPECT_NEAR(offset(day, 0), *without.offsets[day < 3 ? 2 : 3] - *all.offsets[3], 1e-6);
      } else {
        EXPECT_TRUE(std::isnan(offset(day, 0)));  // what that day alone sees
      }
    }
    EXPECT_TRUE(messageOf([&] { step.change(all.place); }).starts_with("[slom.stale-clustered]"));
    const MatrixXd one_step = slom::clustered(all.est, {.by = {"day"}}).change(all.place);
    largest = (one_step - place).cwiseAbs().maxCoeff();
    EXPECT_GT(largest, 1e-3);  // so that the two are told apart
    EXPECT_LT(largest, 0.5);
    EXPECT_EQ(one_step.row(0).hasNaN(), false);
  }
}

TEST(ClusteredRefit, LeavesEverythingAsItWas) {
  Ranging all;
  range(all, -1, true);
  all.est.bound(all.place, "x", -10, 10);
  all.est.fix(all.offsets[1]);
  ASSERT_TRUE(all.est.optimize().converged);
  all.est.update();
  const vec2 place = *all.place;
  const double offset = *all.offsets[4], rss = all.est.getRSS();
  const VectorXd residuals = all.est.residuals(), deviations = all.est.standardDeviation(all.place);
  static_cast<void>(slom::clustered(all.est, {.by = {"day"}, .refit = true}));
  EXPECT_EQ(*all.place, place);
  EXPECT_EQ(*all.offsets[4], offset);
  EXPECT_EQ(all.est.getRSS(), rss);
  EXPECT_EQ(all.est.residuals(), residuals);
  EXPECT_EQ(all.est.standardDeviation(all.place), deviations);
  EXPECT_EQ(all.est.getN(), 7);
  all.est.update();
  EXPECT_LT((*all.place - place).norm(), 1e-9);
}

TEST(ClusteredRefit, JackknifeCovariance) {
  Ranging all;
  range(all);
  const slom::Clustered c =
      slom::clustered(all.est, {.by = {"day"}, .correction = slom::ClusterCorrection::cr3, .refit = true});
  const MatrixXd change = c.change(all.place);
  EXPECT_LT((c.covariance(all.place) - 5.0 / 6 * change.transpose() * change).norm(), 1e-12);
  EXPECT_NEAR(c.influence(all.place)(2, 1), change(2, 1) / c.standardDeviation(all.place)[1], 1e-12);
  // Other corrections are those of the linear problem.
  const slom::Clustered cr2 = slom::clustered(all.est, {.by = {"day"}, .refit = true});
  const MatrixXd C = cr2.covariance(all.place);
  EXPECT_LT((C - slom::clustered(all.est, {.by = {"day"}}).covariance(all.place)).norm(), 1e-9);
}

TEST(ClusteredRefit, WithoutAGroupThatTheFitNeeds) {
  slom::Estimator est;
  const auto line = est.insertRV(vec2(0, 0), "line");
  const auto at = [](const auto& x, double t) { return x[0] + t * x[1]; };
  for (int i = 0; i < 6; ++i)
    est.insertMeasurement(at, line, i < 2 ? 1.0 * i : 0.0, slom::measured(0.5 * i * i),
                          slom::group("day", i / 2));
  ASSERT_TRUE(est.optimize().converged);
  const slom::Clustered c = slom::clustered(est, {.by = {"day"}, .refit = true});
  const MatrixXd change = c.change(line);
  EXPECT_TRUE(std::isnan(change(0, 0)));
  EXPECT_TRUE(std::isnan(change(0, 1)));
  EXPECT_FALSE(change.bottomRows(2).hasNaN());
  EXPECT_EQ(
      c.notes().back(),
      "the fit does not converge without day 0; covariances take one step there, and changes are not known");
}

TEST(ClusteredRefit, Errors) {
  slom::Estimator est;
  const auto a = est.insertRV(0.0, "a"), b = est.insertRV(0.0, "b");
  for (int i = 0; i < 4; ++i)
    est.insertMeasurement([](const auto& x, const auto& y) { return y - x; }, a, b, slom::measured(1.0 * i),
                          slom::group(i));
  est.changeAlgorithm(slom::LevenbergMarquardt());
  ASSERT_TRUE(est.optimize().converged);
  est.setFreeGauge(slom::FreeGauge::inner_constraints);
  EXPECT_EQ(
      messageOf([&] { slom::clustered(est, {.refit = true}); }),
      "[slom.bad-option] ClusterOptions::refit compares the values of fits, which differ by a motion of "
      "everything while the gauge is free; fix the gauge, or drop refit");
}

}  // namespace
