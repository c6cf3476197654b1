// Whether updates know how accurate they are, and whether a window stays as cheap as it is.
#include <algorithm>
#include <cmath>
#include <malloc.h>
#include <random>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include <slom/fixed_lag.hpp>
#include <slom/measurements.hpp>
#include <slom/slom.hpp>

#include "support/slow_with_sanitizers.hpp"

namespace slom {
namespace {

using Pose = mtk::trafo<mtk::SO2<>>;
using Point = mtk::vect<2>;

/// A robot in the plane: odometry, and relative poses to poses some steps ago.
class Robot {
 public:
  explicit Robot(unsigned seed) : random_(seed) {
    start_ = est.insertRV(Pose(), "start");
    last_ = start_;
    est.prior(start_, measured(Pose()), kSigma);
    recent_.emplace_back(last_, truth_);
  }

  Estimator est;

  void step() {
    const Pose motion({0.5, 0.1 * uniform()}, mtk::SO2<>(0.4 * uniform()));
    const Pose odometry = measured(motion);
    truth_ = truth_ * motion;
    const VarID<Pose> next = est.insertRV(*last_ * odometry);
    edge(last_, next, odometry);
    for (const std::size_t back : {3, 7}) {
      if (recent_.size() <= back) continue;
      const auto& [id, truth] = recent_[recent_.size() - 1 - back];
      edge(id, next, measured(truth.inverse() * truth_));
    }
    last_ = next;
    recent_.emplace_back(last_, truth_);
    if (recent_.size() > 8) recent_.erase(recent_.begin());
  }
  const VarID<Pose>& last() const { return last_; }
  /// Normalised estimation error squared: its mean is 3, its variance 6.
  double nees() const {
    Eigen::Vector3d error;
    mtk::boxminus(mtk::vectview<double, 3>(error.data()), truth_, *last_);
    return error.dot(est.updatedCovariance(last_).ldlt().solve(error));
  }

 private:
  static constexpr double kSigma = 0.05;
  /// Returns a pose with isotropic noise.
  Pose measured(const Pose& pose) {
    std::normal_distribution<double> normal(0, kSigma);
    const double x = normal(random_), y = normal(random_), angle = normal(random_);
    return {Point(pose.pos + Point(x, y)), pose.orient * mtk::SO2<>(angle)};
  }
  double uniform() { return std::uniform_real_distribution<double>(-1, 1)(random_); }
  void edge(const VarID<Pose>& a, const VarID<Pose>& b, const Pose& z) {
    est.insertMeasurement(RelativePose(), a, b, slom::measured(z), StandardDeviation(kSigma));
  }

  std::mt19937 random_;
  Pose truth_;
  VarID<Pose> start_, last_;
  std::vector<std::pair<VarID<Pose>, Pose>> recent_;
};

constexpr int kRuns = 200;

void expectConsistent(double nees) { EXPECT_NEAR(nees / kRuns, 3, 4 * std::sqrt(6.0 / kRuns)); }

TEST(OnlineConsistency, UpdatesKnowHowFarOffTheyAre) {
  double nees = 0;
  for (int run = 0; run < kRuns; ++run) {
    Robot robot(static_cast<unsigned>(run));
    for (int i = 0; i < 25; ++i) {
      robot.step();
      ASSERT_TRUE(robot.est.update().converged);
    }
    nees += robot.nees();
  }
  expectConsistent(nees);
}

TEST(OnlineConsistency, SoDoesAWindow) {
  double nees = 0;
  for (int run = 0; run < kRuns; ++run) {
    Robot robot(static_cast<unsigned>(1000 + run));
    FixedLag window({.variables = 10});
    for (int i = 0; i < 40; ++i) {
      robot.step();
      window.add(robot.last());
      ASSERT_TRUE(robot.est.update().converged);
      if (i < 39) window.forget(robot.est);
    }
    EXPECT_LE(robot.est.getN(), 3 * 12);
    nees += robot.nees();
  }
  expectConsistent(nees);
}

/// Memory in use and work of a step, at the end of a long replay as at its begin.
TEST(OnlineWindow, StaysAsSmallAndAsCheap) {
  SLOM_SKIP_WITH_SANITIZERS();
  constexpr int kSteps = 40'000, kFirst = 2'000;
  Robot robot(7);
  FixedLag window({.variables = 10});
  std::size_t memory = 0;
  double first_flops = 0, last_flops = 0;
  int largest = 0;
  for (int i = 0; i < kSteps; ++i) {
    robot.step();
    window.add(robot.last());
    const UpdateSummary update = robot.est.update();
    ASSERT_TRUE(update.converged) << i << ": " << update;
    window.forget(robot.est);
    largest = std::max(largest, update.measurements_linearized);
    if (i >= kFirst / 2 && i < kFirst) first_flops += update.flops;
    if (i >= kSteps - kFirst / 2) last_flops += update.flops;
    if (i == kFirst) memory = mallinfo2().uordblks;
  }
  EXPECT_NEAR(last_flops / first_flops, 1, 0.1);
  EXPECT_LT(largest, 1000);
  EXPECT_LT(static_cast<double>(mallinfo2().uordblks), 1.1 * static_cast<double>(memory));
}

}  // namespace
}  // namespace slom
