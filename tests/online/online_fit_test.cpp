// The online fit: at every step the optimum of the batch fit, whatever was inserted, removed, fixed or moved before.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <sstream>
#include <vector>

#include <gtest/gtest.h>

#include <slom/fixed_lag.hpp>
#include <slom/measurements.hpp>
#include <slom/slom.hpp>

#include "base/words.hpp"
#include "support/message_of.hpp"
#include "support/slow_with_sanitizers.hpp"

namespace slom {
namespace {

using Pose = mtk::trafo<mtk::SO2<>>;
using Point = mtk::vect<2>;

/// A robot in the plane that walks about and sees landmarks and earlier places. Anything may be changed at any time.
class Walk {
 public:
  explicit Walk(unsigned seed, Loss loss = {}) : random_(seed), loss_(std::move(loss)) {
    poses_.push_back(est.insertRV(Pose(), false, "start"));
    is_fixed_.push_back(true);
    truth_.emplace_back();
  }

  Estimator est;

  void step() {
    const Pose motion({1 + noise(0.2), noise(0.2)}, mtk::SO2<>(noise(0.4)));
    const Pose measured(motion.pos + Point(noise(0.05), noise(0.05)),
                        motion.orient * mtk::SO2<>(noise(0.02)));
    truth_.push_back(truth_.back() * motion);
    poses_.push_back(est.insertRV(*poses_.back() * measured));
    is_fixed_.push_back(false);
    edges_.push_back(est.insertMeasurement(RelativePose(), poses_[poses_.size() - 2], poses_.back(),
                                           slom::measured(measured), StandardDeviation(0.05)));
    is_chain_.push_back(true);
    if (uniform() < 0.5) close();
    if (uniform() < 0.3) see();
  }
  void close() {
    const std::size_t a = index(poses_.size()), b = index(poses_.size());
    if (a == b) return;
    Pose z = truth_[a].inverse() * truth_[b];
    z.pos += Point(noise(0.05), noise(0.05));
    edges_.push_back(
        est.insertMeasurement(RelativePose(), poses_[a], poses_[b], measured(z), StandardDeviation(0.05)));
    is_chain_.push_back(false);
  }
  void see() {
    const std::size_t a = index(poses_.size());
    if (landmarks_.empty() || uniform() < 0.3) {
      const Point p = truth_[a] * Point(noise(3), noise(3));
      landmark_truth_.push_back(p);
      landmarks_.push_back(est.insertRV(*poses_[a] * (truth_[a].inverse() * p)));
    }
    const std::size_t l = index(landmarks_.size());
    const Point z = truth_[a].inverse() * landmark_truth_[l] + Point(noise(0.05), noise(0.05));
    est.insertMeasurement(Landmark(), poses_[a], landmarks_[l], measured(z), StandardDeviation(0.05),
                          Huber(3));
  }
  void removeClosure() {
    const std::size_t e = index(edges_.size());
    if (is_chain_[e]) return;
    est.removeMeasurement(edges_[e]);
    edges_.erase(edges_.begin() + static_cast<std::ptrdiff_t>(e));
    is_chain_.erase(is_chain_.begin() + static_cast<std::ptrdiff_t>(e));
  }
  void fixOrFree() {
    const std::size_t a = 1 + index(poses_.size() - 1);
    est.optimizeRV(poses_[a], is_fixed_[a]);
    is_fixed_[a] = !is_fixed_[a];
  }
  void fixComponent() {
    const std::size_t a = index(poses_.size());
    if (uniform() < 0.5) {
      est.fix(poses_[a], "pos.y");
    } else {
      est.free(poses_[a]);
    }
  }
  void push() {
    const std::size_t a = index(poses_.size());
    est.reinitRV(poses_[a], *poses_[a] * Pose({noise(0.1), noise(0.1)}, mtk::SO2<>(noise(0.05))));
  }

  void any() {
    if (poses_.size() < 5 || uniform() < 0.5) return step();
    switch (index(7)) {
      case 0:
        return close();
      case 1:
        return see();
      case 2:
        return removeClosure();
      case 3:
        return fixOrFree();
      case 4:
        return fixComponent();
      case 5:
        return push();
      default:
        est.optimize();
        return;
    }
  }

  double uniform() { return std::uniform_real_distribution<double>()(random_); }

  /// Compares covariances of pairs of poses after updates with those of the batch fit, relative to the standard
  /// deviations.
  void expectCovariances(double most) {
    for (int k = 0; k < 4; ++k) {
      const auto &a = poses_[index(poses_.size())],
                 &b = k == 0 ? poses_.back() : poses_[index(poses_.size())];
      const Eigen::MatrixXd online = est.updatedCovariance(a, b), batch = est.covariance(a, b);
      const Eigen::MatrixXd scale = est.standardDeviation(a) * est.standardDeviation(b).transpose();
      EXPECT_TRUE(((online - batch).array().abs() <= most * scale.array()).all()) << online << "\n\n"
                                                                                  << batch << "\n";
    }
  }

 private:
  double noise(double sigma) { return sigma * std::normal_distribution<double>()(random_); }
  std::size_t index(std::size_t count) {
    return std::uniform_int_distribution<std::size_t>(0, count - 1)(random_);
  }

  std::mt19937 random_;
  Loss loss_;
  std::vector<VarID<Pose>> poses_;
  std::vector<Pose> truth_;
  std::vector<VarID<Point>> landmarks_;
  std::vector<Point> landmark_truth_;
  using EdgeID = decltype(std::declval<Estimator&>().insertMeasurement(
      RelativePose(), std::declval<VarID<Pose>>(), std::declval<VarID<Pose>>(), slom::measured(Pose()),
      StandardDeviation(1.0)));
  std::vector<EdgeID> edges_;
  std::vector<bool> is_chain_, is_fixed_;
};

void expectOptimumAfterAnyOperations(unsigned seed, const Loss& loss, double most) {
  Walk walk(seed, loss);
  for (int i = 0; i < (testing::hasSanitizers() ? 60 : 200); ++i) {
    walk.any();
    if (walk.uniform() < 0.3) continue;  // several changes at once
    const UpdateSummary online = walk.est.update();
    ASSERT_TRUE(online.converged) << "seed " << seed << ", operation " << i << ": " << online.message;
    const double rss = walk.est.getRSS();
    EXPECT_NEAR(online.rss, rss, 1e-9 * rss + 1e-20);
    walk.est.optimize();
    EXPECT_LE(rss, (1 + most) * walk.est.getRSS() + 1e-12) << "seed " << seed << ", operation " << i;
  }
}

TEST(OnlineFit, IsAtTheBatchOptimumAfterAnyOperations) {
  for (unsigned seed = 0; seed < 10; ++seed) expectOptimumAfterAnyOperations(seed, {}, 2e-6);
}

/// Next to the kink of Huber's loss, the curvature is overestimated. A step then predicts less decrease than all
/// further steps together achieve.
TEST(OnlineFit, IsNearTheBatchOptimumWithLosses) {
  for (unsigned seed = 0; seed < 5; ++seed) expectOptimumAfterAnyOperations(seed, Huber(3), 1e-5);
}

/// A window that forgets: priors of marginalisation appear and disappear.
TEST(OnlineFit, FollowsAWindow) {
  Estimator est;
  FixedLag window({.variables = 20});
  std::mt19937 random(3);
  const auto noise = [&](double sigma) { return sigma * std::normal_distribution<double>()(random); };
  const Point tower(3, 8), mill(-6, 12);
  const auto a = est.insertRV(tower, false), b = est.insertRV(mill, false);  // known places
  Pose truth;
  VarID<Pose> last = est.insertRV(truth);
  est.insertMeasurement([](const auto& p) { return p; }, last, measured(truth), StandardDeviation(0.1));
  window.add(last);
  for (int i = 0; i < 150; ++i) {
    const Pose motion({0.5, 0}, mtk::SO2<>(0.05));
    truth = truth * motion;
    const Pose odometry = motion * Pose({noise(0.05), noise(0.05)}, mtk::SO2<>(noise(0.01)));
    const VarID<Pose> next = est.insertRV(*last * odometry);
    est.insertMeasurement(RelativePose(), last, next, measured(odometry), StandardDeviation(0.05));
    for (const auto& [id, place] : {std::pair(a, tower), std::pair(b, mill)}) {
      const Point seen = truth.inverse() * place;
      est.insertMeasurement(Landmark(), next, id, measured(Point(seen + Point(noise(0.1), noise(0.1)))),
                            StandardDeviation(0.1));
    }
    last = next;
    window.add(last);
    const UpdateSummary online = est.update();
    ASSERT_TRUE(online.converged) << i << ": " << online.message;
    const double rss = est.getRSS();
    est.optimize();
    EXPECT_LE(rss, (1 + 2e-6) * est.getRSS() + 1e-12) << i;
    window.forget(est);
  }
  EXPECT_LT(est.getN(), 80);
}

/// If new measurements have only local effect, the number of moved variables does not grow with the problem.
TEST(OnlineFit, DoesNoMoreAlongALongerChain) {
  Estimator est;
  std::mt19937 random(4);
  const auto noise = [&](double sigma) { return sigma * std::normal_distribution<double>()(random); };
  std::vector<VarID<Pose>> poses{est.insertRV(Pose(), false)};
  Pose truth;
  double linearized = 0, fronts = 0;
  const int count = testing::hasSanitizers() ? 1000 : 4000;
  for (int i = 1; i < count; ++i) {
    const Pose motion({1, 0}, mtk::SO2<>(noise(0.1)));
    truth = truth * motion;
    const Pose odometry = motion * Pose({noise(0.05), noise(0.05)}, mtk::SO2<>(noise(0.05)));
    poses.push_back(est.insertRV(*poses.back() * odometry));
    est.insertMeasurement(RelativePose(), poses[poses.size() - 2], poses.back(), measured(odometry),
                          StandardDeviation(0.05));
    est.insertMeasurement([](const auto& p) { return p.pos; }, poses.back(),
                          measured(Point(truth.pos + Point(noise(0.1), noise(0.1)))), StandardDeviation(0.1));
    const UpdateSummary update = est.update();
    ASSERT_TRUE(update.converged && !update.used_optimize) << i << ": " << update.message;
    if (update.reordered) continue;
    linearized += update.measurements_linearized;
    fronts += update.fronts_solved;
  }
  EXPECT_LT(linearized / count, 100);  // out of up to 8000
  EXPECT_LT(fronts / count, 30);       // out of up to 500
}

TEST(OnlineFit, NamesWhatNothingDetermines) {
  Estimator est;
  const auto a = est.insertRV(Point(1, 2), "a");
  est.insertMeasurement([](const auto& p) { return p[0] - 3; }, a);
  UpdateSummary summary = est.update();
  EXPECT_TRUE(summary.converged);
  EXPECT_EQ(summary.undetermined, std::vector<std::string>{"a.y"});
  EXPECT_EQ(*a, Point(3, 2));
  est.insertMeasurement([](const auto& p) { return p[1] - p[0] - 1; }, a);
  summary = est.update();
  EXPECT_TRUE(summary.undetermined.empty());
  EXPECT_LT((*a - Point(3, 4)).norm(), 1e-7);
}

TEST(OnlineFit, HasCovariancesBetweenUpdates) {
  int compared = 0;
  for (unsigned seed = 0; seed < 8; ++seed) {
    Walk walk(seed);
    for (int i = 0; i < 60; ++i) {
      walk.any();
      const UpdateSummary update = walk.est.update();
      ASSERT_TRUE(update.converged);
      if (i % 3 != 0 || !update.undetermined.empty()) continue;  // a landmark that nobody has seen yet
      walk.expectCovariances(
          1e-2);  // Jacobians in the factor differ by up to 3e-4, in sums over the whole walk
      ++compared;
    }
  }
  EXPECT_GT(compared, 40);
}

/// A measurement without a residual is refused by name; once it is gone, all is as it would be without it.
TEST(OnlineFit, GoesOnAfterAnError) {
  Estimator est;
  const auto a = est.insertRV(Point(1, 2), "a"), b = est.insertRV(Point(0, 0), "b");
  est.insertMeasurement([](const auto& p) { return p; }, a, measured(Point(3, 4)));
  est.insertMeasurement([](const auto& p, const auto& q) { return q - p; }, a, b, measured(Point(1, 1)));
  EXPECT_TRUE(est.update().converged);
  const auto bad = est.insertMeasurement([](const auto& p) { return p; }, a, measured(Point(std::nan(""), 0)),
                                         named("bad"));
  est.insertMeasurement([](const auto& p) { return p; }, b, measured(Point(6, 7)));
  EXPECT_EQ(
      testing::messageOf([&] { est.update(); }),
      "[slom.not-finite] the residual of measurement bad #1 is not finite at a = (3 4); check its data, the function "
      "where it divides, takes roots or logarithms or leaves an entry of its result unset, and the start values");
  EXPECT_LT((*a - Point(3, 4)).norm(), 1e-7);
  est.removeMeasurement(bad);
  EXPECT_TRUE(est.update().converged);
  EXPECT_LT((*b - Point(16. / 3, 19. / 3)).norm(), 1e-3);
}

/// A huge residual swallows digits of the RSS. After its removal, the RSS and the tolerance are right again.
TEST(OnlineFit, KnowsTheRssAfterHugeResiduals) {
  for (const double off : {1e4, 1e6, 1e8, 1e10, 1e14}) {
    Estimator est;
    const auto x = est.insertRV(1.0, "x"), y = est.insertRV(2.0, "y");
    for (const double z : {0.5, 1.5, 3.0}) {
      est.insertMeasurement([](const auto& v) { return v; }, x, measured(z));
      est.insertMeasurement([](const auto& v) { return v; }, y, measured(z));
    }
    est.update();
    const auto bad = est.insertMeasurement([](const auto& a, const auto& b) { return b - a; }, x, y,
                                           measured(off), StandardDeviation(0.01));
    est.update();
    EXPECT_NEAR(est.update().rss, est.getRSS(), 1e-9 * est.getRSS()) << off;
    est.removeMeasurement(bad);
    const UpdateSummary summary = est.update();
    EXPECT_TRUE(summary.converged);
    EXPECT_NEAR(summary.rss, est.getRSS(), 1e-9 * est.getRSS()) << off;
    const double mean = 5. / 3;
    EXPECT_NEAR(*x, mean, 1e-2) << off;
    EXPECT_NEAR(*y, mean, 1e-2) << off;
    // A start that is far off, which goes by itself.
    est.reinitRV(x, off);
    EXPECT_TRUE(est.update().converged);
    EXPECT_NEAR(est.update().rss, est.getRSS(), 1e-9 * est.getRSS()) << off;
    EXPECT_NEAR(*x, mean, 1e-2) << off;
  }
}

TEST(OnlineFit, LeavesBoundsToTheBatchFit) {
  Estimator est;
  const auto a = est.insertRV(Point(1, 2), "a");
  est.insertMeasurement([](const auto& p) { return p; }, a, measured(Point(3, 4)));
  est.bound(a, "x", 0, 2);
  const UpdateSummary summary = est.update();
  EXPECT_TRUE(summary.converged && summary.used_optimize) << summary.message;
  EXPECT_EQ((*a)[0], 2);
  EXPECT_NEAR(summary.rss, 1, 1e-9);
}

/// Undetermined unknowns stay where they are, even beside a bound and if steps go uphill.
TEST(OnlineFit, MovesTheOthersWhereOptimizeTakesOver) {
  for (const bool is_bounded : {false, true}) {
    Estimator est;
    const auto a = est.insertRV(Point(1, 2), "a");
    // Newton's method runs away from here.
    est.insertMeasurement(
        [](const auto& p) {
          using std::atan;
          return atan(p[0]);
        },
        a);
    est.reinitRV(a, Point(3, 2));
    if (is_bounded) est.bound(a, "x", -1, 4);
    const UpdateSummary summary = est.update();
    EXPECT_TRUE(summary.converged && summary.used_optimize) << summary;
    EXPECT_NEAR((*a)[0], 0, 1e-3);
    EXPECT_EQ((*a)[1], 2);
    EXPECT_EQ(std::isnan(summary.promise), is_bounded);
    EXPECT_EQ(summary.undetermined.size(), is_bounded ? 0u : 1u);
  }
}

/// With odometry alone, the RSS consists of rounding errors. Nothing can be gained, so nothing moves.
TEST(OnlineFit, LeavesRoundingErrorsAlone) {
  Estimator est;
  std::mt19937 random(5);
  std::vector<VarID<Pose>> poses{est.insertRV(Pose({1e4, -2e4}, mtk::SO2<>(0.3)), false)};
  for (int i = 1; i < 1000; ++i) {
    const double angle = std::normal_distribution<double>(0, 0.3)(random);
    const Pose z({1.7, 0.3}, mtk::SO2<>(angle));
    poses.push_back(est.insertRV(*poses.back() * z));
    est.insertMeasurement(RelativePose(), poses[poses.size() - 2], poses.back(), measured(z),
                          StandardDeviation(1e-3));
    const UpdateSummary summary = est.update();
    ASSERT_TRUE(summary.converged) << i << ": " << summary;
    ASSERT_LT(summary.variables_moved, 5) << i;
  }
  // Real misfits are not taken for rounding errors, however small their unit.
  Estimator tiny;
  const auto x = tiny.insertRV(1e-9);
  for (const double z : {1e-9, 2e-9}) tiny.insertMeasurement([](const auto& v) { return v; }, x, measured(z));
  EXPECT_TRUE(tiny.update().converged);
  EXPECT_NEAR(*x, 1.5e-9, 1e-12);
}

/// A measurement that is nearly exact to the last digit does not hide the information of the others.
TEST(OnlineFit, FitsBesideAMeasurementNearlyWithoutNoise) {
  Estimator est;
  const auto x = est.insertRV(1e8), y = est.insertRV(1e8);
  est.insertMeasurement([](const auto& a, const auto& b) { return a - b; }, x, y, measured(0.125),
                        StandardDeviation(1e-6));
  est.update();
  for (const double z : {1e8 + 0.5, 1e8 + 1.0, 1e8 + 1.75})
    est.insertMeasurement([](const auto& v) { return v; }, y, measured(z), StandardDeviation(0.5));
  EXPECT_TRUE(est.update().converged);
  EXPECT_NEAR(*y - 1e8, 3.25 / 3, 0.005);
  EXPECT_NEAR(*x - *y, 0.125, 1e-7);
}

TEST(OnlineFit, SaysWhatItDid) {
  Estimator est;
  const auto a = est.insertRV(Point(1, 2), "a");
  est.insertMeasurement([](const auto& p) { return p[0] - 3; }, a);
  std::ostringstream text;
  text << est.update();
  EXPECT_EQ(text.str(),
            "converged: a further step is predicted to reduce the RSS by 0, within the tolerance\n"
            "RSS 0, 1 step, 1 move, 2 linearisations, 1 front\n"
            "not determined by measurements: a.y\n");
}

/// A robot that drives in circles and sees one earlier place in each circle. Each closure takes several steps.
struct Circles {
  explicit Circles(const UpdateOptions& options) {
    std::mt19937 random(3);
    std::normal_distribution<double> normal(0, 1);
    constexpr int around = 40;
    const Pose step({1, 0}, mtk::SO2<>(2 * 3.14159265358979 / around));
    std::vector<VarID<Pose>> poses{est.insertRV(Pose(), false)};
    for (int i = 1; i <= 8 * around; ++i) {
      const double x = 0.05 * normal(random), y = 0.05 * normal(random), turn = 0.02 * normal(random);
      const Pose z(step.pos + Point(x, y), step.orient * mtk::SO2<>(turn));
      poses.push_back(est.insertRV(*poses.back() * z));
      est.insertMeasurement(RelativePose(), poses[poses.size() - 2], poses.back(), measured(z),
                            StandardDeviation(0.05));
      if (i % around == 0) {
        est.insertMeasurement(RelativePose(), poses[poses.size() - 1 - around], poses.back(),
                              measured(Pose()), StandardDeviation(0.01));
      }
      updates.push_back(est.update(options));
    }
  }

  Estimator est;
  std::vector<UpdateSummary> updates;
};

TEST(OnlineFit, PutsOffStepsBeyondItsBudget) {
  constexpr double budget = 1e5;
  Circles free({}), bounded({.budget = budget});
  double worst = 0;
  int put_off = 0;
  for (std::size_t i = 0; i < free.updates.size(); ++i) {
    const UpdateSummary& update = bounded.updates[i];
    EXPECT_FALSE(free.updates[i].is_put_off);
    EXPECT_FALSE(update.used_optimize || update.needs_optimize);
    EXPECT_NE(update.converged, update.is_put_off);
    if (update.is_put_off) {
      ++put_off;
      EXPECT_GE(update.flops, budget);
      EXPECT_GT(update.promise, 0);
      // Before the last step there was some of the budget left.
      EXPECT_EQ(update.message, "a further step is predicted to reduce the RSS by " +
                                    number(update.promise, 3) +
                                    ", and the budget of 1e+05 operations is used up; call update() again");
    }
    worst = std::max(worst, free.updates[i].flops);
  }
  EXPECT_GT(put_off, 3);
  const auto most = std::max_element(bounded.updates.begin(), bounded.updates.end(),
                                     [](const auto& a, const auto& b) { return a.flops < b.flops; });
  EXPECT_LT(most->flops, 0.7 * worst);
  for (int i = 0; i < 100 && !bounded.est.update({.budget = 1}).converged; ++i) {
  }
  const double reached = bounded.est.getRSS();
  EXPECT_NEAR(reached / free.est.getRSS(), 1, 2e-6);
  bounded.est.optimize();
  EXPECT_NEAR(reached / bounded.est.getRSS(), 1, 1e-6);
}

TEST(OnlineFit, LeavesAnUphillStepToOptimizeWhereThereIsABudget) {
  const auto curve = [](const auto& x) {
    using std::atan;
    return atan(x);
  };
  Estimator est;
  const auto x = est.insertRV(3.0);
  est.insertMeasurement(curve, x, measured(0.0), StandardDeviation(1));
  const UpdateSummary update = est.update({.budget = 1e9});
  EXPECT_FALSE(update.converged || update.used_optimize);
  EXPECT_TRUE(update.needs_optimize);
  EXPECT_EQ(update.message,
            "a step led uphill, far away, or to a place where an unknown has no influence; without a budget, "
            "optimize() would take over; call optimize() when there is time");
  EXPECT_EQ(*x, 3.0);
  EXPECT_TRUE(est.update().used_optimize);
  EXPECT_NEAR(*x, 0, 1e-6);
}

TEST(OnlineFit, GoesOnWhereAnUnknownHasLostItsInfluence) {
  // a b c + e a^2: steps may lead to a = 0, where no residual changes with b.
  const auto product = [](const auto& a, const auto& b, double c, double e) { return a * b * c + e * a * a; };
  int handed_over = 0, undetermined = 0;
  for (unsigned seed = 1; seed <= 150; ++seed) {
    std::mt19937 engine(seed);
    std::normal_distribution<double> normal;
    Estimator est;
    est.setThreads(1);
    const double a_start = normal(engine), b_start = normal(engine);
    const auto a = est.insertRV(a_start, "a"), b = est.insertRV(b_start, "b");
    UpdateSummary update;
    for (int i = 0; i < 3; ++i) {
      const double c = normal(engine), e = normal(engine), y = normal(engine);
      est.insertMeasurement(product, a, b, c, e, measured(y), StandardDeviation(0.3));
      if (i > 0) update = est.update();
    }
    if (!update.converged) continue;
    handed_over += update.used_optimize ? 1 : 0;
    const double rss = est.getRSS();
    if (est.optimize().final_rss >= 0.99 * rss - 1e-9) continue;
    // Where b had no influence before the last measurement came, either, it is named.
    EXPECT_EQ(update.undetermined, std::vector<std::string>{"b"}) << seed << "\n" << update;
    ++undetermined;
  }
  EXPECT_GT(handed_over, 3);
  EXPECT_LT(undetermined, 5);
}

TEST(OnlineFit, RefusesOptionsWithoutSense) {
  Estimator est;
  EXPECT_EQ(testing::messageOf([&] { est.update({.tolerance = 0}); }),
            "[slom.bad-option] tolerance is 0; pass a number between 0 and 1, such as 1e-6");
  EXPECT_EQ(testing::messageOf([&] { est.update({.tolerance = std::numeric_limits<double>::infinity()}); }),
            "[slom.bad-option] tolerance is inf; pass a number between 0 and 1, such as 1e-6");
  EXPECT_EQ(testing::messageOf([&] { est.update({.max_steps = 0}); }),
            "[slom.bad-option] max_steps is 0; pass a positive number, such as 100");
  EXPECT_EQ(testing::messageOf([&] { est.update({.budget = 0}); }),
            "[slom.bad-option] budget is 0; pass a positive number of operations, such as 1e6");
  EXPECT_EQ(testing::messageOf([&] { est.update({.budget = std::numeric_limits<double>::quiet_NaN()}); }),
            "[slom.bad-option] budget is nan; pass a positive number of operations, such as 1e6");
  EXPECT_TRUE(est.update().converged);
}

}  // namespace
}  // namespace slom
