// First-estimate Jacobians: motions that no measurement observes stay free while a window runs.
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "slom/fixed_lag.hpp"
#include "slom/linearize/linearize.hpp"
#include "slom/measurements.hpp"
#include "slom/measurements/gaussian_prior.hpp"
#include "slom/slom.hpp"
#include "support/slow_with_sanitizers.hpp"

namespace slom {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Point2 = mtk::vect<2>;
using Point3 = mtk::vect<3>;
using Pose2 = mtk::trafo<mtk::SO2<>>;
using Pose3 = mtk::trafo<mtk::SO3<>>;

/// Whitened Jacobian and residual of all measurements over all variables, dense.
std::pair<MatrixXd, VectorXd> linearized(const Estimator& est) {
  const Problem& problem = est.table();
  std::vector<int> offset;
  int columns = 0, rows = 0, row = 0;
  for (const VariableRecord& record : problem.variables())
    offset.push_back(std::exchange(columns, columns + record.dof));
  for (const auto& pool : problem.pools()) rows += pool->totalRows();
  MatrixXd J = MatrixXd::Zero(rows, columns);
  VectorXd r(rows);
  Linearizer linearizer;
  for (int p = 0; p < static_cast<int>(problem.pools().size()); ++p) {
    const MeasurementPool& pool = *problem.pools()[std::size_t(p)];
    for (int i = 0; i < pool.size(); ++i) {
      const JacobianBatch batch = linearizer.linearizeOne(problem, problem.activeSet(), p, i);
      const int n = batch.rows[0];
      const double* next = batch.J;
      for (int k = 0; k < pool.arity(); ++k) {
        const int v = pool.variables(i)[k], dof = batch.dof[k];
        J.block(row, offset[std::size_t(v)], n, dof) += Eigen::Map<const MatrixXd>(next, n, dof);
        next += n * dof;
      }
      r.segment(row, n) = Eigen::Map<const VectorXd>(batch.r, n);
      row += n;
    }
  }
  return {J, r};
}

/// Returns the number of directions that no row observes, for columns of length 1: singular values below 1e-10 of the
/// largest. Singular values that are not rounding are far above.
int freeDirections(const Estimator& est) {
  MatrixXd J = linearized(est).first;
  int unused = 0;  // places of variables that have been removed
  for (int c = 0; c < J.cols(); ++c) {
    const double length = J.col(c).norm();
    if (length > 0) {
      J.col(c) /= length;
    } else {
      ++unused;
    }
  }
  const VectorXd s = Eigen::BDCSVD<MatrixXd>(J).singularValues();
  return static_cast<int>((s.array() < 1e-10 * s[0]).count() + J.cols() - s.size()) - unused;
}

/// A window that moves with a robot. Values are fitted at each step, so linearisation points differ.
class Window {
 public:
  Window(int variables, bool first_estimates)
      : lag_({.variables = variables, .first_estimates = first_estimates}) {
    est.changeAlgorithm(LevenbergMarquardt());
  }
  virtual ~Window() = default;

  Estimator est;

  virtual void step(int i) = 0;
  /// The smallest and the largest number of free directions within these steps.
  std::pair<int, int> run(int steps, int check_each) {
    int least = 1000, most = 0;
    for (int i = 0; i < steps; ++i) {
      step(i);
      est.optimize({.max_iterations = 3});
      lag_.forget(est);
      if (i < 20 || i % check_each != 0) continue;
      const int free = freeDirections(est);
      least = std::min(least, free);
      most = std::max(most, free);
    }
    return {least, most};
  }

 protected:
  double noise(double sigma) { return noise_factor_ * sigma * std::normal_distribution<double>()(random_); }
  Point3 noise3(double sigma) { return {noise(sigma), noise(sigma), noise(sigma)}; }

  double noise_factor_ = 1;
  std::mt19937 random_{7};
  FixedLag lag_;
};

/// A robot in the plane that drives around a circle through landmarks.
class PlanarWindow final : public Window {
 public:
  explicit PlanarWindow(bool first_estimates, bool starts_free = true, int variables = 16,
                        double noise_factor = 1)
      : Window(variables, first_estimates), starts_free_(starts_free) {
    noise_factor_ = noise_factor;
  }

  void step(int i) override {
    constexpr double turn = 0.1;
    const Pose2 motion({1, 0}, mtk::SO2<>(turn));
    truth_ = i == 0 ? Pose2() : truth_ * motion;
    if (i == 0) {
      pose_ = est.insertRV(Pose2(), starts_free_);
    } else {
      const VarID<Pose2> before = pose_;
      const Pose2 z(motion.pos + Point2(noise(0.05), noise(0.05)), mtk::SO2<>(turn + noise(0.05)));
      pose_ = est.insertRV(*before * z);
      est.insertMeasurement(RelativePose(), before, pose_, measured(z), StandardDeviation(0.05));
    }
    lag_.add(pose_);
    if (i % 2 == 0) {
      seen_.push_back({truth_ * Point2(2 + noise(0.5), noise(2)), {}});
      if (seen_.size() > 5) seen_.erase(seen_.begin());
    }
    for (auto& [at, id] : seen_) {
      const Point2 z = truth_.inverse() * at + Point2(noise(0.1), noise(0.1));
      if (!id.isValid()) id = est.insertRV(*pose_ * z);
      est.insertMeasurement(Landmark(), pose_, id, measured(z), StandardDeviation(0.1));
      lag_.add(id, i + 0.5);
    }
  }

  void forget() { lag_.forget(est); }
  const Pose2& newest() const { return *pose_; }

 private:
  bool starts_free_;
  Pose2 truth_;
  VarID<Pose2> pose_;
  std::vector<std::pair<Point2, VarID<Point2>>> seen_;
};

/// Poses in space, each measured from the three before; with gravity each also sees which way is up.
class SpatialWindow final : public Window {
 public:
  SpatialWindow(bool has_gravity, bool first_estimates)
      : Window(7, first_estimates), has_gravity_(has_gravity) {}

  void step(int i) override {
    const Pose3 motion(mtk::SO3<>::exp(Point3(0.05 * std::sin(0.1 * i), 0.03, 0.1)), Point3(1, 0, 0.1));
    truths_.push_back(i == 0 ? Pose3() : truths_.back() * motion);
    for (std::size_t back = 1; back <= 3 && back < truths_.size(); ++back) {
      const Pose3 exact = truths_[truths_.size() - 1 - back].inverse() * truths_.back();
      const Pose3 z = exact * Pose3(mtk::SO3<>::exp(noise3(0.05)), noise3(0.05));
      if (back == 1) ids_.push_back(est.insertRV(*ids_.back() * z));
      est.insertMeasurement(RelativePose(), ids_[ids_.size() - 1 - back], ids_.back(), measured(z),
                            StandardDeviation(0.05));
    }
    if (i == 0) ids_.push_back(est.insertRV(Pose3()));
    if (has_gravity_) {
      const mtk::S2<> up(truths_.back().orient.inverse() * Point3(0, 0, 1) + noise3(0.05));
      est.insertMeasurement(GravityDirection(), ids_.back(), mtk::S2<>(0, 0, 1), measured(up),
                            StandardDeviation(0.05));
    }
    lag_.add(ids_.back());
  }

 private:
  bool has_gravity_;
  std::vector<Pose3> truths_;
  std::vector<VarID<Pose3>> ids_;
};

/// Four poses in a loop. The first is marginalised, then the others are moved.
struct Loop {
  Estimator est;
  std::vector<VarID<Pose2>> poses;
  std::vector<MeasID<GaussianPrior>> priors;

  explicit Loop(bool first_estimates) {
    for (int i = 0; i < 4; ++i)
      poses.push_back(est.insertRV(Pose2({std::cos(i), std::sin(2.0 * i)}, mtk::SO2<>(0.5 * i))));
    const auto relate = [&](std::size_t a, std::size_t b) {
      est.insertMeasurement(RelativePose(), poses[a], poses[b], measured(Pose2({1, 0.5}, mtk::SO2<>(0.7))),
                            StandardDeviation(0.1));
    };
    for (std::size_t i = 0; i < 4; ++i) relate(i, (i + 1) % 4);
    relate(1, 3);
    priors = est.marginalize({poses[0]}, {.first_estimates = first_estimates});
  }
  void move() {
    for (std::size_t i = 1; i < 4; ++i) {
      if (!poses[i].isValid()) continue;
      est.reinitRV(poses[i], *poses[i] * Pose2({0.3, 0.1 * double(i)}, mtk::SO2<>(0.4)));
    }
  }
};

TEST(FirstEstimates, AreWhereJacobiansAreTakenAndNotResiduals) {
  Loop with(true), without(false);
  const MatrixXd at_first = linearized(with.est).first;
  EXPECT_EQ(at_first, linearized(without.est).first);
  const Pose2 first1 = *with.poses[1], first3 = *with.poses[3];
  with.move();
  without.move();
  const auto [J, r] = linearized(with.est);
  const auto [J_now, r_now] = linearized(without.est);
  EXPECT_EQ(r, r_now);
  EXPECT_EQ(with.est.getRSS(), without.est.getRSS());
  EXPECT_GT((J - J_now).norm(), 0.1 * J.norm());
  // The other poses of a measurement count where they are now.
  with.est.reinitRV(with.poses[1], first1);
  with.est.reinitRV(with.poses[3], first3);
  EXPECT_EQ(J, linearized(with.est).first);
  EXPECT_NE(J, at_first);
}

TEST(FirstEstimates, GoWithTheLastPriorOfAVariable) {
  Loop with(true), without(false);
  const FirstEstimates& first = with.est.table().firstEstimates();
  EXPECT_TRUE(without.est.table().firstEstimates().isEmpty());
  const std::vector<MeasID<GaussianPrior>> more =
      with.est.marginalize({with.poses[2]}, {.first_estimates = true});
  without.est.marginalize({without.poses[2]});
  with.move();
  for (const auto& id : with.priors) with.est.removeMeasurement(id);
  EXPECT_FALSE(first.isEmpty());  // the other prior is over the same poses
  const MatrixXd J = linearized(with.est).first;
  const Pose2 at = *with.poses[1];
  with.est.reinitRV(with.poses[1], at * Pose2({1, 1}, mtk::SO2<>(1)));
  EXPECT_EQ(linearized(with.est).first, J);
  with.est.reinitRV(with.poses[1], at);
  for (const auto& id : more) with.est.removeMeasurement(id);
  EXPECT_TRUE(first.isEmpty());
  without.move();
  const auto [J_plain, r_plain] = linearized(without.est);
  const MatrixXd J_left = linearized(with.est).first;  // one measurement is left, the first one of both
  EXPECT_EQ(J_left, J_plain.topRows(J_left.rows()));
}

/// A prior that is made later of measurements with first estimates is linearised there, too.
TEST(FirstEstimates, AreThoseOfLaterPriors) {
  Loop loop(true);
  loop.move();
  const auto [J, r] = linearized(loop.est);
  const MatrixXd H = J.transpose() * J;
  const VectorXd g = J.transpose() * r;
  // The Schur complement of pose 2 in what it was measured with, over poses 1 and 3. Columns are those of poses 1 to 3.
  const auto blockOf = [&](int a, int b) { return H.block<3, 3>(3 * (a - 1), 3 * (b - 1)); };
  const std::vector<MeasID<GaussianPrior>> priors = loop.est.marginalize({loop.poses[2]});
  const auto [J_left, r_left] = linearized(loop.est);
  const MatrixXd H_left = J_left.transpose() * J_left;
  const VectorXd g_left = J_left.transpose() * r_left;
  const Eigen::Matrix3d inverse = blockOf(2, 2).inverse();
  ASSERT_EQ(H_left.rows(), 6);
  for (const int a : {1, 3}) {
    const int row = a == 1 ? 0 : 3;
    for (const int b : {1, 3}) {
      EXPECT_LT(
          (H_left.block<3, 3>(row, b == 1 ? 0 : 3) - blockOf(a, b) + blockOf(a, 2) * inverse * blockOf(2, b))
              .norm(),
          1e-10 * H.norm());
    }
    EXPECT_LT((g_left.segment<3>(row) - g.segment<3>(3 * (a - 1)) + blockOf(a, 2) * inverse * g.segment<3>(3))
                  .norm(),
              1e-10 * g.norm());
  }
}

/// Both fits end where J^T r = 0 for the window's Jacobians.
TEST(FirstEstimates, FitsOfAWindowConverge) {
  PlanarWindow batch(true, false), online(true, false), plain(false, false), damped(true);
  batch.est.changeAlgorithm(GaussNewton());
  std::vector<int> by_optimize, by_optimize_without;  // the steps at which optimize() took over
  for (int i = 0; i < 200; ++i) {
    for (PlanarWindow* window : {&batch, &online, &plain, &damped}) window->step(i);
    if (i > 0) {
      const Summary fit = batch.est.optimize();
      EXPECT_TRUE(fit.converged) << i << ": " << fit.message;
      const Summary damped_fit = damped.est.optimize();  // nothing is fixed
      EXPECT_TRUE(damped_fit.converged) << i << ": " << damped_fit.message;
    }
    const UpdateSummary update = online.est.update();
    EXPECT_TRUE(update.converged) << i << ": " << update.message;
    if (update.used_optimize) by_optimize.push_back(i);
    if (plain.est.update().used_optimize) by_optimize_without.push_back(i);
    const auto [J, r] = linearized(batch.est);
    const VectorXd g = J.transpose() * r;
    EXPECT_LT(g.cwiseQuotient(J.colwise().norm().transpose().cwiseMax(1e-300)).norm(), 0.03) << i;
    EXPECT_LT((batch.newest().pos - online.newest().pos).norm(), 3e-3) << i;
    for (PlanarWindow* window : {&batch, &online, &plain, &damped}) window->forget();
  }
  EXPECT_LE(by_optimize.size(), by_optimize_without.size() + 2)
      << ::testing::PrintToString(by_optimize) << ::testing::PrintToString(by_optimize_without);
}

/// If residuals are large, steps to the root of J^T r often raise the RSS.
TEST(FirstEstimates, LargeResidualsTakeFewIterations) {
  PlanarWindow window(true, false, 8, 4);
  window.est.changeAlgorithm(GaussNewton());
  int most = 0;
  for (int i = 0; i < 300; ++i) {
    window.step(i);
    if (i > 0) {
      const Summary fit = window.est.optimize();
      EXPECT_TRUE(fit.converged) << i << ": " << fit.message;
      most = std::max(most, fit.iterations);
    }
    window.forget();
  }
  EXPECT_LE(most, 20);
}

/// As docs/windows.md shows it.
TEST(FirstEstimates, AreAnOptionOfAWindow) {
  FixedLag window({.variables = 16, .first_estimates = true});
  PlanarWindow steps(true);
  EXPECT_EQ(window.forget(steps.est), 0);
}

TEST(FirstEstimates, DiagnosesSeeTheGaugeOfAWindow) {
  PlanarWindow window(true);
  EXPECT_EQ(window.run(60, 1), std::pair(3, 3));
  const Diagnosis diagnosis = diagnose(window.est);
  EXPECT_EQ(diagnosis.rank, diagnosis.unknowns - 3);
  ASSERT_FALSE(diagnosis.findings.empty());
  EXPECT_EQ(diagnosis.findings[0].kind, Finding::Kind::gauge) << diagnosis;
  EXPECT_EQ(diagnosis.findings[0].dimension, 3);
}

const int kSteps = ::slom::testing::hasSanitizers() ? 100 : 400;

TEST(FirstEstimates, AWindowInThePlaneKeepsThreeFreeDirections) {
  EXPECT_EQ(PlanarWindow(true).run(kSteps, 25), std::pair(3, 3));
  EXPECT_EQ(PlanarWindow(false).run(100, 1).first, 2);  // the heading is claimed to be known
}

TEST(FirstEstimates, AWindowOfPosesInSpaceKeepsSixFreeDirections) {
  EXPECT_EQ(SpatialWindow(false, true).run(kSteps, 25), std::pair(6, 6));
  EXPECT_EQ(SpatialWindow(false, false).run(100, 1).first, 3);
}

TEST(FirstEstimates, AWindowThatSeesGravityKeepsFourFreeDirections) {
  EXPECT_EQ(SpatialWindow(true, true).run(kSteps, 25), std::pair(4, 4));
  EXPECT_EQ(SpatialWindow(true, false).run(100, 1).first, 3);
}

}  // namespace
}  // namespace slom
