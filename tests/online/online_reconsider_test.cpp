// Trials of refused measurements for which a call has no budget left: they wait, and nothing is lost.
#include <sstream>
#include <vector>

#include <gtest/gtest.h>

#include <slom/measurements.hpp>
#include <slom/slom.hpp>

namespace slom {
namespace {

using Pose = mtk::trafo<mtk::SO2<>>;
using Point = mtk::vect<2>;
using Closure = decltype(std::declval<Estimator&>().insertMeasurement(
    RelativePose(), std::declval<VarID<Pose>>(), std::declval<VarID<Pose>>(), measured(Pose()),
    StandardDeviation(1), Loss()));

/// Odometry along a line drifts sidewards by more than the losses of true closures let through.
class Drift {
 public:
  explicit Drift(int steps) {
    for (int i = 0; i < steps; ++i) drive();
    est.update();
  }

  Estimator est;
  std::vector<VarID<Pose>> poses{est.insertRV(Pose(), false, "start")};

  /// Adds two odometers that disagree, so that the RSS is not only that of the closures.
  void drive() {
    const auto z = [](double length) { return Pose({length, 0.03}, mtk::SO2<>(0)); };
    poses.push_back(est.insertRV(*poses.back() * z(1)));
    for (const double length : {0.85, 1.15}) {
      est.insertMeasurement(RelativePose(), poses[poses.size() - 2], poses.back(), measured(z(length)),
                            StandardDeviation(0.14));
    }
  }
  /// Adds a measurement of the position of pose i.
  Closure close(int i) {
    return est.insertMeasurement(RelativePose(), poses[0], poses[std::size_t(i)],
                                 measured(Pose({double(i), 0}, mtk::SO2<>(0))), StandardDeviation(0.05),
                                 Tukey(5));
  }
  std::vector<Point> positions() const {
    std::vector<Point> all;
    for (const auto& pose : poses) all.push_back(pose->pos);
    return all;
  }
};

/// Operations of a call in which the closure of the last of so many poses is tried to the end.
double operationsOfTrial(int steps) {
  Drift drift(steps);
  drift.close(steps);
  return drift.est.update({.reconsider = true}).flops;
}

TEST(OnlineReconsider, ATrialThatTheBudgetEndsIsTakenBackAndWaits) {
  constexpr int n = 30;
  Drift drift(n);
  const Closure closure = drift.close(n);
  const double budget = operationsOfTrial(n) / 4;
  const UpdateSummary cut = drift.est.update({.budget = budget, .reconsider = true});
  EXPECT_GE(cut.flops, budget);
  EXPECT_EQ(cut.waiting, 1);
  EXPECT_EQ(cut.reconsidered, 0);
  EXPECT_EQ(cut.accepted, 0);
  EXPECT_TRUE(cut.converged);
  EXPECT_LT(drift.est.weight(closure), 0.01);
  EXPECT_NEAR(drift.poses.back()->pos.y(), 0.03 * n, 0.01);  // taken back

  EXPECT_EQ(drift.est.update().waiting, 1);  // which tries nothing

  const UpdateSummary all = drift.est.update({.reconsider = true});
  EXPECT_EQ(all.reconsidered, 1);
  EXPECT_EQ(all.accepted, 1);
  EXPECT_EQ(all.waiting, 0);
  EXPECT_GT(drift.est.weight(closure), 0.5);
  EXPECT_NEAR(drift.poses.back()->pos.y(), 0, 0.1);
}

/// A trial continues where the last call ended it.
TEST(OnlineReconsider, ATrialTakesSeveralCallsWithASmallBudget) {
  constexpr int n = 30;
  Drift drift(n);
  const Closure closure = drift.close(n);
  const double budget = operationsOfTrial(n) / 6;
  const std::vector<Point> before = drift.positions();
  int calls = 0;
  UpdateSummary update;
  for (update.waiting = 1; update.waiting > 0 && calls < 50; ++calls) {
    update = drift.est.update({.budget = budget, .reconsider = true});
    EXPECT_TRUE(update.waiting == 0 || drift.positions() == before);
  }
  EXPECT_GT(calls, 1);
  EXPECT_LT(calls, 50);
  EXPECT_EQ(update.accepted, 1);
  EXPECT_GT(drift.est.weight(closure), 0.5);
}

TEST(OnlineReconsider, ATrialBeginsAgainWhereVariablesWereMovedMeanwhile) {
  constexpr int n = 30;
  Drift drift(n);
  const Closure closure = drift.close(n);
  const double budget = operationsOfTrial(n) / 6;
  for (int i = 0; i < 20; ++i) {
    drift.est.reinitRV(drift.poses[5], *drift.poses[5] * Pose({0.001, 0}, mtk::SO2<>(0)));
    EXPECT_EQ(drift.est.update({.budget = budget, .reconsider = true}).waiting, 1);
  }
  EXPECT_EQ(drift.est.update({.reconsider = true}).accepted, 1);
  EXPECT_GT(drift.est.weight(closure), 0.5);
}

/// The map of calls with a budget becomes that of calls without.
TEST(OnlineReconsider, CallsWithABudgetComeToTheSameMap) {
  constexpr int n = 20;
  const double budget = operationsOfTrial(n) / 2;
  Drift free(n), bounded(n);
  for (Drift* drift : {&free, &bounded}) {
    drift->close(n);
    drift->close(n - 7);
    drift->close(n - 1);
  }
  const UpdateSummary once = free.est.update({.reconsider = true});
  EXPECT_EQ(once.waiting, 0);
  int tried = 0, accepted = 0, calls = 0;
  for (int waiting = 1; waiting > 0 && calls < 20; ++calls) {
    const UpdateSummary update = bounded.est.update({.budget = budget, .reconsider = true});
    tried += update.reconsidered;
    accepted += update.accepted;
    waiting = update.waiting;
  }
  EXPECT_GT(calls, 1);
  EXPECT_LT(calls, 20);
  EXPECT_EQ(tried, once.reconsidered);
  EXPECT_EQ(accepted, once.accepted);
  EXPECT_GT(accepted, 0);
  for (std::size_t i = 0; i < free.poses.size(); ++i)
    EXPECT_LT((bounded.poses[i]->pos - free.poses[i]->pos).norm(), 1e-3);
}

TEST(OnlineReconsider, StepsOfTrialsCountAmongTheLargestNumberOfSteps) {
  Drift drift(30);
  const Closure closure = drift.close(30);
  const UpdateSummary cut = drift.est.update({.max_steps = 1, .reconsider = true});
  EXPECT_EQ(cut.steps, 1);
  EXPECT_EQ(cut.waiting, 1);
  EXPECT_EQ(cut.reconsidered, 0);
  const UpdateSummary all = drift.est.update({.max_steps = 50, .reconsider = true});
  EXPECT_GE(all.steps, 1);
  EXPECT_EQ(all.accepted, 1);
  EXPECT_GT(drift.est.weight(closure), 0.5);
}

TEST(OnlineReconsider, WhatIsRemovedOrNoLongerRefusedWaitsNoLonger) {
  Drift drift(30);
  const Closure removed = drift.close(30);
  drift.close(29);
  const UpdateOptions little{.budget = 1, .reconsider = true};
  drift.est.update(little);  // the first step is always taken
  EXPECT_EQ(drift.est.update(little).waiting, 2);
  drift.est.removeMeasurement(removed);
  EXPECT_EQ(drift.est.update(little).waiting, 1);
  // Without a loss the map is moved to agree with the other one.
  drift.est.insertMeasurement(RelativePose(), drift.poses[0], drift.poses[29],
                              measured(Pose({29, 0}, mtk::SO2<>(0))), StandardDeviation(0.01));
  const UpdateSummary moved = drift.est.update({.reconsider = true});
  EXPECT_EQ(moved.waiting, 0);
  EXPECT_EQ(moved.reconsidered, 0);
}

/// Only inserted measurements are new, and only calls that reconsider store them.
TEST(OnlineReconsider, TriesNoMeasurementTwice) {
  Drift drift(30);
  drift.close(30);
  drift.est.update();
  drift.close(29);
  UpdateSummary update = drift.est.update({.reconsider = true});
  EXPECT_EQ(update.reconsidered, 1);
  EXPECT_EQ(update.waiting, 0);

  Drift bent(30);  // a false closure that stays refused
  bent.est.insertMeasurement(RelativePose(), bent.poses[0], bent.poses[30],
                             measured(Pose({10, 30}, mtk::SO2<>(2))), StandardDeviation(0.05), Tukey(5));
  update = bent.est.update({.reconsider = true});
  EXPECT_EQ(update.reconsidered, 1);
  EXPECT_EQ(update.accepted, 0);
  bent.est.optimizeRV(bent.poses[30], false);
  EXPECT_EQ(bent.est.update({.reconsider = true}).reconsidered, 0);
  bent.est.optimizeRV(bent.poses[30], true);
  update = bent.est.update({.reconsider = true});
  EXPECT_EQ(update.reconsidered, 0);
  EXPECT_EQ(update.waiting, 0);
}

TEST(OnlineReconsider, SaysWhatWaits) {
  Drift drift(30);
  drift.close(30);
  const UpdateSummary one = drift.est.update({.max_steps = 1, .reconsider = true});
  EXPECT_TRUE(one.message.ends_with(", within the tolerance; 1 refused measurement waits for a trial"))
      << one.message;
  drift.close(29);
  const UpdateSummary two = drift.est.update({.max_steps = 1, .reconsider = true});
  EXPECT_TRUE(two.message.ends_with(", within the tolerance; 2 refused measurements wait for a trial"))
      << two.message;
  std::ostringstream text;
  text << two;
  EXPECT_NE(text.str().find("\n0 refused measurements tried, 0 accepted, 2 waiting\n"), std::string::npos)
      << text.str();
}

}  // namespace
}  // namespace slom
