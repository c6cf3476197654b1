#include "slom/solve/block_solver.hpp"

#include <cmath>

#include "base/stopwatch.hpp"
#include "block/block_method.hpp"
#include "mtk/error.hpp"
#include "slom/solve/block_qr.hpp"

namespace slom {

using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

void check(const BlockSolverOptions& options) {
  if (!(options.forcing > 0 && options.forcing < 1)) {
    throw mtk::Error("slom.bad-option", "forcing is " + std::to_string(options.forcing) +
                                            "; pass a number between 0 and 1, such as 0.1");
  }
  if (options.max_iterations < 1) {
    throw mtk::Error("slom.bad-option", "max_iterations of conjugate gradients is " +
                                            std::to_string(options.max_iterations) +
                                            "; pass a positive number, such as 500");
  }
}

}  // namespace

struct BlockSolver::Implementation {
  BlockSolverOptions options;
  BlockStructure structure;
  NormalEquations equations;
  std::unique_ptr<BlockMethod> method;  // null before analyze()

  BlockMethod& ready() {
    if (!method)
      throw mtk::Error("slom.not-analyzed", "the block solver knows no structure yet; call analyze() first");
    return *method;
  }
};

BlockSolver::BlockSolver(const BlockSolverOptions& options) : self_(new Implementation) {
  check(options);
  self_->options = options;
}
BlockSolver::~BlockSolver() = default;

void BlockSolver::analyze(const BlockStructure& structure) {
  self_->method.reset();
  self_->structure = structure;
  self_->method = chooseMethod(self_->structure, self_->options, self_->equations);
}

void BlockSolver::beginLinearization() {
  self_->ready().forget();
  self_->equations.setZero();
}
void BlockSolver::add(const JacobianBatch& batch) { self_->equations.add(batch); }
std::span<const MeasurementPlace> BlockSolver::parts() const { return self_->equations.parts(); }
void BlockSolver::endLinearization() { self_->equations.addUp(); }

SolveStatus BlockSolver::solve(const VectorXd& damping, VectorXd& step) {
  VectorXd x = -gradient();
  SolveStatus status;
  {
    const detail::Stopwatch watch(seconds_.factorize);
    status = self_->ready().prepare(damping, &x);
  }
  if (!status.ok) return status;
  const detail::Stopwatch watch(seconds_.solve);
  status = self_->method->solveStep(x);
  if (status.ok) step = std::move(x);
  return status;
}

SolveStatus BlockSolver::solveFor(const MatrixXd& B, MatrixXd& X) { return solveDamped({}, B, X); }

SolveStatus BlockSolver::solveDamped(const VectorXd& damping, const MatrixXd& B, MatrixXd& X) {
  SolveStatus status = self_->ready().prepare(damping);
  MatrixXd all(B.rows(), B.cols());
  VectorXd x;
  for (Eigen::Index j = 0; status.ok && j < B.cols(); ++j) {
    x = B.col(j);
    status = self_->method->solve(x);
    all.col(j) = x;
  }
  if (status.ok) X = std::move(all);
  return status;
}

double BlockSolver::leastOfColumn() const { return isExact() ? std::sqrt(kPivotTolerance) : 0; }

std::unique_ptr<LinearSolver> BlockSolver::careful(double least) const {
  return isExact() ? std::make_unique<BlockQR>(least) : nullptr;
}

SolveStatus BlockSolver::invertBlocks(const BlockStructure& structure,
                                      std::unique_ptr<InverseBlocks>& blocks) {
  return isExact() ? invertDamped({}, blocks) : LinearSolver::invertBlocks(structure, blocks);
}

SolveStatus BlockSolver::invertDamped(const VectorXd& damping, std::unique_ptr<InverseBlocks>& blocks) {
  const SolveStatus status = self_->ready().prepare(damping);
  if (status.ok) blocks = self_->method->invertBlocks();
  return status;
}

bool BlockSolver::isExact() const {
  if (self_->method) return self_->method->isExact();
  return self_->options.method != BlockSolverOptions::Method::conjugate_gradients;
}
const VectorXd& BlockSolver::gradient() const { return self_->equations.gradient(); }
const VectorXd& BlockSolver::diagonal() const { return self_->equations.diagonal(); }
double BlockSolver::squaredImage(const VectorXd& d) const { return self_->equations.squaredImage(d); }
double BlockSolver::flops() const { return self_->method ? self_->method->flops() : 0; }

std::string BlockSolver::description() const {
  return self_->method ? self_->method->description() : "block solver that has solved nothing yet";
}

}  // namespace slom
