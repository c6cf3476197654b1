// First-estimate Jacobians: a window keeps the motions that no measurement sees free, for as long as it runs.
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

/// Number of directions that no row sees, of columns of length 1: singular values below 1e-10 of the largest. What is not rounding is far above.
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

/// A window that moves with a robot. Values are fitted at each step, so that linearisation points differ.
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
  double noise(double sigma) { return sigma * std::normal_distribution<double>()(random_); }
  Point3 noise3(double sigma) { return {noise(sigma), noise(sigma), noise(sigma)}; }

  std::mt19937 random_{7};
  FixedLag lag_;
};

/// A robot in the plane that drives around a circle through landmarks.
class PlanarWindow final : public Window {
 public:
  explicit PlanarWindow(bool first_estimates) : Window(16, first_estimates) {}

  void step(int i) override {
    constexpr double turn = 0.1;
    const Pose2 motion({1, 0}, mtk::SO2<>(turn));
    truth_ = i == 0 ? Pose2() : truth_ * motion;
    if (i == 0) {
      pose_ = est.insertRV(Pose2());
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

 private:
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

TEST(FirstEstimates, AWindowInThePlaneKeepsThreeFreeDirections) {
  EXPECT_EQ(PlanarWindow(true).run(1000, 10), std::pair(3, 3));
  EXPECT_EQ(PlanarWindow(false).run(100, 1).first, 2);  // the heading is claimed to be known
}

TEST(FirstEstimates, AWindowOfPosesInSpaceKeepsSixFreeDirections) {
  EXPECT_EQ(SpatialWindow(false, true).run(1000, 10), std::pair(6, 6));
  EXPECT_EQ(SpatialWindow(false, false).run(100, 1).first, 3);
}

TEST(FirstEstimates, AWindowThatSeesGravityKeepsFourFreeDirections) {
  EXPECT_EQ(SpatialWindow(true, true).run(1000, 10), std::pair(4, 4));
  EXPECT_EQ(SpatialWindow(true, false).run(100, 1).first, 3);
}

}  // namespace
}  // namespace slom
