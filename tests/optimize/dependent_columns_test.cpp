// Claims of convergence if columns of J are nearly dependent, or out of sight.
#include <cmath>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include <Eigen/QR>
#include <gtest/gtest.h>

#include <slom/measurements.hpp>
#include <slom/slom.hpp>
#include <slom/solve/block_solver.hpp>
#include <slom/solve/forwarding_solver.hpp>

namespace {

using LongMatrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
using LongVector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

/// Twelve equations in three unknowns. The last column differs by `apart` from a combination of the others.
struct Linear {
  LongMatrix A{12, 3};
  LongVector b{12};
  Linear(double apart, int k) {
    for (int i = 0; i < 12; ++i) {
      const double u = std::sin(1 + i * 0.7 + k), v = std::cos(2.3 * i * i + k),
                   w = std::cos(5.1 * i + k * k);
      A.row(i) << u, w, u + 0.5 * w + apart * v;
      b[i] = std::sin(17. * i * i + 3 * k) * 3;
    }
  }
  slom::VarID<mtk::vect<3>> insert(slom::Estimator& est) const {
    const auto x = est.insertRV(mtk::vect<3>(0, 0, 0), "x");
    for (int i = 0; i < 12; ++i) {
      const mtk::vect<3> row(double(A(i, 0)), double(A(i, 1)), double(A(i, 2)));
      est.insertMeasurement([](const auto& v, const mtk::vect<3>& a,
                               const double& y) { return a[0] * v[0] + a[1] * v[1] + a[2] * v[2] - y; },
                            x, row, double(b[i]));
    }
    return x;
  }
  /// The least RSS, by pivoted QR in long double.
  double least() const {
    const Eigen::ColPivHouseholderQR<LongMatrix> qr(A);
    return double((A * qr.solve(b) - b).squaredNorm());
  }
};

TEST(NearlyDependent, ColumnsNeverMakeAFalseClaim) {
  int claims = 0;
  for (const double apart : {1e-6, 1e-7, 1e-8, 3e-9, 1e-9, 3e-10}) {
    for (int k = 0; k < 40; ++k) {
      const Linear problem(apart, k);
      for (int method = 0; method < 5; ++method) {
        slom::Estimator est;
        est.setThreads(1);
        problem.insert(est);
        if (method == 1) est.changeAlgorithm(slom::LevenbergMarquardt());
        if (method == 2) est.changeAlgorithm(slom::DogLeg());
        if (method == 3) est.changeSolver(std::make_unique<slom::BlockQR>());
        if (method == 4) est.changeSolver(std::make_unique<slom::DenseQR>());
        slom::Options options;
        options.max_iterations = 100;
        const slom::Summary summary = est.optimize(options);
        double lowest = summary.initial_rss;  // and then a hundredth of a standard deviation, squared
        for (const auto& line : summary.trace) lowest = std::min(lowest, line.rss);
        EXPECT_LE(summary.final_rss, lowest * (1 + 1e-4 / 9)) << apart << ", " << k << ", " << method;
        if (!summary.converged) continue;
        ++claims;
        EXPECT_LE(summary.final_rss, problem.least() + 1e-4 * problem.least() / 9)
            << apart << ", " << k << ", " << method << "\n"
            << summary;
        for (const auto& group : summary.groups) {
          EXPECT_TRUE(group.redundancy < 0 || std::abs(group.redundancy - 9) < 0.01) << group.redundancy;
        }
      }
    }
  }
  EXPECT_GT(claims, 600);
}

TEST(NearlyDependent, SolverAndDiagnosisAgree) {
  for (const double apart : {1e-6, 1e-7, 1e-8, 1e-9, 1e-11, 1e-12}) {
    slom::Estimator est;
    Linear(apart, 1).insert(est);
    const bool is_determined = est.optimize().stop_reason != slom::StopReason::rank_deficient;
    EXPECT_EQ(is_determined, apart >= 1e-9) << apart;
    EXPECT_EQ(slom::diagnose(est).rank == 3, is_determined) << apart;
  }
}

/// Standard deviations have five digits wherever there are any, whichever way they are asked for.
TEST(NearlyDependent, StandardDeviationsHold) {
  for (const double apart : {1e-3, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6, 1e-7, 1e-8}) {
    for (int k = 0; k < 20; ++k) {
      const Linear problem(apart, k);
      slom::Estimator est;
      est.setThreads(1);
      const auto x = problem.insert(est);
      ASSERT_TRUE(est.optimize().converged) << apart << ", " << k;
      LongMatrix A(12, 3);  // with the numbers that the measurements got
      for (int i = 0; i < 12; ++i) A.row(i) = problem.A.row(i).cast<double>().cast<long double>();
      const LongMatrix R =
          Eigen::HouseholderQR<LongMatrix>(A).matrixQR().topRows(3).triangularView<Eigen::Upper>();
      const LongMatrix inverse = R.triangularView<Eigen::Upper>().solve(LongMatrix::Identity(3, 3));
      const Eigen::VectorXd expected = inverse.rowwise().norm().cast<double>();
      const Eigen::VectorXd one = est.standardDeviation(x), all = est.marginals().standardDeviation(x);
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(one[c] / expected[c], 1, 1e-5) << apart << ", " << k;
        EXPECT_NEAR(all[c] / expected[c], 1, 1e-5) << apart << ", " << k;
      }
    }
  }
}

/// A start at which a Gaussian is flat to all digits.
TEST(OutOfSight, AFlatStartIsNoOptimum) {
  for (double start = 9; start <= 27; start += 0.5) {
    slom::Estimator est;
    const auto x = est.insertRV(start, "x"), y = est.insertRV(1.0, "y");
    est.insertMeasurement([](const auto& v) { return v - 2.0; }, y);
    est.insertMeasurement([](const auto& v) { return 1.0 - exp(-0.5 * v * v); }, x);
    est.changeAlgorithm(slom::LevenbergMarquardt());
    const slom::Summary summary = est.optimize();
    EXPECT_TRUE(!summary.converged || summary.final_rss < 1e-6) << start << "\n" << summary;
  }
}

/// Counts how often J is factorised to find out about the rank.
class Watched final : public slom::ForwardingSolver {
 public:
  explicit Watched(int& factorizations)
      : ForwardingSolver(std::make_unique<slom::BlockSolver>()), factorizations_(factorizations) {}
  std::unique_ptr<slom::LinearSolver> careful(double least) const override {
    return std::make_unique<Careful>(ForwardingSolver::careful(least), factorizations_);
  }

 private:
  struct Careful final : slom::ForwardingSolver {
    Careful(std::unique_ptr<LinearSolver> solver, int& count)
        : ForwardingSolver(std::move(solver)), count_(count) {}
    slom::SolveStatus solve(const Eigen::VectorXd& damping, Eigen::VectorXd& step) override {
      ++count_;
      return ForwardingSolver::solve(damping, step);
    }
    int& count_;
  };
  int& factorizations_;
};

/// Rotating all cameras and points changes nothing. Such motions are tried before J is factorised. The parameters of a
/// lens do not turn with the world.
TEST(FreeGauge, OfCamerasAndPointsIsFoundByItsMotions) {
  using Point = mtk::vect<3>;
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  const auto any = [&] {
    const double x = normal(random), y = normal(random), z = normal(random);
    return Point(x, y, z);
  };
  slom::Estimator est;
  int factorizations = 0;
  est.changeAlgorithm(slom::GaussNewton());
  est.changeSolver(std::make_unique<Watched>(factorizations));
  std::vector<slom::VarID<slom::SnavelyCamera>> cameras;
  std::vector<slom::VarID<Point>> points;
  for (int i = 0; i < 4; ++i) {
    slom::SnavelyCamera camera;
    camera.pose.pos = any();
    camera.pose.orient = mtk::SO3<>::exp(0.1 * any());
    camera.intrinsics = slom::SnavelyIntrinsics<>(500, 0.01, 0.02);
    cameras.push_back(est.insertRV(camera));
  }
  for (int i = 0; i < 30; ++i) points.push_back(est.insertRV(Point(2 * any() - Point(0, 0, 10))));
  for (const auto& camera : cameras) {
    for (const auto& point : points) {
      est.insertMeasurement(slom::Reprojection(), camera, point,
                            slom::measured(slom::Reprojection()(*camera, *point)),
                            slom::StandardDeviation(1));
    }
  }
  for (const auto& point : points) est.reinitRV(point, *point + 0.01 * any());
  EXPECT_EQ(est.optimize({.fall_back = false}).stop_reason, slom::StopReason::rank_deficient);
  EXPECT_EQ(factorizations, 0);
}

}  // namespace
