// A user's own solvers and algorithms that return vectors of a wrong length: the error says so, and nothing is lost.
#include <memory>

#include <gtest/gtest.h>

#include "slom/estimator.hpp"
#include "slom/optimize/evaluator.hpp"
#include "slom/solve/dense_qr.hpp"
#include "slom/solve/forwarding_solver.hpp"
#include "support/message_of.hpp"

namespace slom {
namespace {

enum class Fault { gradient, diagonal, step, no_step, columns, nameless };

class FaultySolver final : public ForwardingSolver {
 public:
  explicit FaultySolver(Fault fault) : ForwardingSolver(std::make_unique<DenseQR>()), fault_(fault) {}

  SolveStatus solve(const Eigen::VectorXd& damping, Eigen::VectorXd& step) override {
    const SolveStatus status = ForwardingSolver::solve(damping, step);
    if (fault_ == Fault::step) step = Eigen::VectorXd::Zero(step.size() + 2);
    if (fault_ == Fault::no_step) step.resize(0);
    return fault_ == Fault::nameless ? SolveStatus{.ok = false} : status;
  }
  SolveStatus solveFor(const Eigen::MatrixXd& B, Eigen::MatrixXd& X) override {
    const SolveStatus status = ForwardingSolver::solveFor(B, X);
    if (fault_ == Fault::columns) X = X.topRows(1).eval();
    return status;
  }
  const Eigen::VectorXd& gradient() const override {
    return fault_ == Fault::gradient ? empty_ : ForwardingSolver::gradient();
  }
  const Eigen::VectorXd& diagonal() const override {
    return fault_ == Fault::diagonal ? empty_ : ForwardingSolver::diagonal();
  }
  std::unique_ptr<LinearSolver> careful(double) const override { return nullptr; }
  std::string description() const override { return "of my own"; }

 private:
  Fault fault_;
  Eigen::VectorXd empty_;
};

/// Takes the right step and gives a shorter one as the one that it took, or tries one that is longer.
class FaultyAlgorithm final : public Algorithm {
 public:
  explicit FaultyAlgorithm(bool tries) : tries_(tries) {}
  std::string name() const override { return "of my own"; }
  std::unique_ptr<Algorithm> clone() const override { return std::make_unique<FaultyAlgorithm>(*this); }
  StepOutcome step(Evaluator& evaluator, const Options&) override {
    StepOutcome outcome;
    outcome.rss_before = evaluator.linearize();
    outcome.status = evaluator.solveUndamped(outcome.step);
    if (tries_) outcome.step = Eigen::VectorXd::Zero(7);
    outcome.rss_after = evaluator.tryStep(outcome.step);
    outcome.step.resize(1);
    outcome.trials = 1;
    return outcome;
  }

 private:
  bool tries_;
};

struct Line {
  Estimator est;
  VarID<Eigen::Vector2d> line = est.insertRV(Eigen::Vector2d(3, 4), "line");
  Line() {
    for (int i = 0; i < 4; ++i)
      est.insertMeasurement([i](const auto& c) { return c[0] + c[1] * i - i * i; }, line);
  }
};

std::string messageWith(Fault fault) {
  Line fit;
  fit.est.changeSolver(std::make_unique<FaultySolver>(fault));
  const std::string message = testing::messageOf([&] {
    if (fault == Fault::columns) {
      static_cast<void>(fit.est.covariance(fit.line));
    } else if (const Summary summary = fit.est.optimize(); !summary.converged) {
      throw Error("summary", summary.message);
    }
  });
  EXPECT_EQ(*fit.line, Eigen::Vector2d(3, 4));
  fit.est.changeSolver(std::make_unique<DenseQR>());
  EXPECT_TRUE(fit.est.optimize().converged);
  return message;
}

TEST(Lengths, OfAUsersSolverAreChecked) {
  const std::string remedy = ", but the problem has 2 unknowns; give one entry for each";
  EXPECT_EQ(messageWith(Fault::gradient),
            "[slom.wrong-length] gradient() of the solver of my own has 0 entries" + remedy);
  EXPECT_EQ(messageWith(Fault::diagonal),
            "[slom.wrong-length] diagonal() of the solver of my own has 0 entries" + remedy);
  EXPECT_EQ(messageWith(Fault::step),
            "[slom.wrong-length] the solution of the solver of my own has 4 entries" + remedy);
  EXPECT_EQ(messageWith(Fault::no_step),
            "[slom.wrong-length] the solution of the solver of my own has 0 entries" + remedy);
  EXPECT_EQ(messageWith(Fault::columns),
            "[slom.wrong-length] the solution of the solver of my own has 1 entry" + remedy);
}

TEST(Lengths, ASolverMayNotSayWhichUnknownIsToBlame) {
  EXPECT_EQ(
      messageWith(Fault::nameless),
      "[summary] [slom.rank-deficient] the solver found no unique solution and does not name an unknown; "
      "slom::diagnose(est) lists what is not determined");
}

TEST(Lengths, OfAUsersAlgorithmAreChecked) {
  for (const bool tries : {false, true}) {
    Line fit;
    fit.est.changeAlgorithm(new FaultyAlgorithm(tries));
    EXPECT_EQ(testing::messageOf([&] { fit.est.optimize(); }),
              "[slom.wrong-length] the step of the algorithm has " +
                  std::string(tries ? "7 entries" : "1 entry") +
                  ", but the problem has 2 unknowns; give one entry for each");
  }
}

}  // namespace
}  // namespace slom
