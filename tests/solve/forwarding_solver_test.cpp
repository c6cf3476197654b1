// A solver that watches another one: the fit is the same, bit for bit, and every call is forwarded.
#include "slom/solve/forwarding_solver.hpp"

#include <memory>

#include <gtest/gtest.h>

#include "slom/estimator.hpp"
#include "slom/measurements.hpp"
#include "slom/solve/block_solver.hpp"
#include "slom/solve/dense_qr.hpp"
#include "support/message_of.hpp"

namespace slom {
namespace {

using Pose = mtk::trafo<mtk::SO2<>>;

class Watching final : public ForwardingSolver {
 public:
  Watching(std::unique_ptr<LinearSolver> solver, int& solves)
      : ForwardingSolver(std::move(solver)), solves_(solves) {}
  SolveStatus solve(const Eigen::VectorXd& damping, Eigen::VectorXd& step) override {
    ++solves_;
    return ForwardingSolver::solve(damping, step);
  }
  std::string description() const override { return "watched " + ForwardingSolver::description(); }

 private:
  int& solves_;
};

struct Fit {
  Estimator est;
  std::vector<VarID<Pose>> poses;

  explicit Fit(std::unique_ptr<LinearSolver> solver) {
    est.changeSolver(std::move(solver));
    for (int i = 0; i < 30; ++i)
      poses.push_back(est.insertRV(Pose({0.9 * i, 0.1 * i}, mtk::SO2<>(0.01 * i))));
    est.fix(poses[0]);
    const Pose step({1., 0.2}, mtk::SO2<>(0.02)), jump({5.1, 1.3}, mtk::SO2<>(0.1));
    for (int i = 0; i + 1 < 30; ++i) {
      est.insertMeasurement(RelativePose(), poses[std::size_t(i)], poses[std::size_t(i + 1)], measured(step),
                            StandardDeviation(0.1));
    }
    for (int i = 0; i + 5 < 30; i += 3) {
      est.insertMeasurement(RelativePose(), poses[std::size_t(i)], poses[std::size_t(i + 5)], measured(jump),
                            StandardDeviation(0.2));
    }
  }
};

template <class Solver>
void expectSameFit() {
  int solves = 0;
  Fit plain(std::make_unique<Solver>()),
      watched(std::make_unique<Watching>(std::make_unique<Solver>(), solves));
  const Summary a = plain.est.optimize(), b = watched.est.optimize();
  EXPECT_EQ(a.final_rss, b.final_rss);
  EXPECT_EQ(a.iterations, b.iterations);
  EXPECT_GE(solves, b.iterations);
  EXPECT_EQ(b.solver, "watched " + a.solver);
  EXPECT_EQ(plain.est.covariance(plain.poses[20]), watched.est.covariance(watched.poses[20]));
  for (std::size_t i = 0; i < plain.poses.size(); ++i) {
    EXPECT_EQ(plain.poses[i]->pos, watched.poses[i]->pos);
  }
}

TEST(ForwardingSolver, LeavesTheFitAsItIs) {
  expectSameFit<BlockSolver>();
  expectSameFit<DenseQR>();
}

TEST(ForwardingSolver, PassesOnWhatTheOtherKnows) {
  int solves = 0;
  const Watching exact(std::make_unique<BlockSolver>(), solves);
  EXPECT_TRUE(exact.isExact());
  EXPECT_EQ(exact.leastOfColumn(), BlockSolver().leastOfColumn());
  EXPECT_NE(exact.careful(1e-6), nullptr);
  using Options = BlockSolverOptions;
  const Watching inexact(
      std::make_unique<BlockSolver>(Options{.method = Options::Method::conjugate_gradients}), solves);
  EXPECT_FALSE(inexact.isExact());
  EXPECT_EQ(inexact.careful(1e-6), nullptr);
}

TEST(ForwardingSolver, NeedsASolver) {
  EXPECT_EQ(testing::messageOf([] { ForwardingSolver solver(nullptr); }),
            "[slom.no-solver] ForwardingSolver got a null pointer; pass a BlockSolver, BlockQR or DenseQR");
}

}  // namespace
}  // namespace slom
