#include "slom/solve/block_solver.hpp"

#include <cmath>

#include "base/stopwatch.hpp"
#include "block/block_method.hpp"
#include "mtk/error.hpp"
#include "slom/solve/block_qr.hpp"
#include "solve/named_list.hpp"
#include "symbolic/compact.hpp"
#include "symbolic/graph.hpp"

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
  CompactStructure compact;
  NormalEquations equations;
  std::unique_ptr<BlockMethod> method;  // null before analyze()

  void choose(CompactStructure now) {
    method.reset();
    compact = std::move(now);
    method = chooseMethod(compact.structure, options, equations);
  }

  BlockMethod& ready() {
    if (!method)
      throw mtk::Error("slom.not-analyzed", "the block solver knows no structure yet; call analyze() first");
    return *method;
  }
};

BlockSolver::BlockSolver(const BlockSolverOptions& options) : impl_(new Implementation) {
  check(options);
  impl_->options = options;
}
BlockSolver::~BlockSolver() = default;

void BlockSolver::analyze(const BlockStructure& structure) {
  ++counts_.analyses;
  impl_->choose(compact(structure));
}

void BlockSolver::update(const BlockStructure& structure, const StructureChanges& changes) {
  if (changes.blocks || !impl_->method) return analyze(structure);
  CompactStructure now = compact(structure);
  if (changes.meetings && makeGraph(now.structure) != makeGraph(impl_->compact.structure)) {
    ++counts_.analyses;
    return impl_->choose(std::move(now));
  }
  std::unique_ptr<BlockMethod> method = std::move(impl_->method);  // gone when memory is
  impl_->compact = std::move(now);
  impl_->equations.layOutMeasurements();
  method->forget();
  impl_->method = std::move(method);
}

void BlockSolver::beginLinearization() {
  impl_->ready().forget();
  impl_->equations.setZero();
}
void BlockSolver::add(const JacobianBatch& batch) { impl_->equations.add(batch); }
std::span<const MeasurementPlace> BlockSolver::parts() const { return impl_->equations.parts(); }
void BlockSolver::endLinearization() { impl_->equations.addUp(); }

SolveStatus BlockSolver::prepare(const VectorXd& damping, VectorXd* x) {
  const long before = impl_->ready().preparations();
  const SolveStatus status = impl_->method->prepare(damping, x);
  counts_.factorizations += impl_->method->preparations() - before;
  return status;
}

SolveStatus BlockSolver::solve(const VectorXd& damping, VectorXd& step) {
  VectorXd x = -gradient();
  SolveStatus status;
  {
    const detail::Stopwatch watch(seconds_.factorize);
    status = prepare(damping, &x);
  }
  if (!status.ok) return status;
  const detail::Stopwatch watch(seconds_.solve);
  status = impl_->method->solveStep(x);
  if (status.ok) step = std::move(x);
  return status;
}

SolveStatus BlockSolver::solveFor(const MatrixXd& B, MatrixXd& X) { return solveDamped({}, B, X); }

SolveStatus BlockSolver::solveDamped(const VectorXd& damping, const MatrixXd& B, MatrixXd& X) {
  SolveStatus status = prepare(damping);
  MatrixXd all(B.rows(), B.cols());
  VectorXd x;
  for (Eigen::Index j = 0; status.ok && j < B.cols(); ++j) {
    x = B.col(j);
    status = impl_->method->solve(x);
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
  const SolveStatus status = prepare(damping);
  if (status.ok) blocks = impl_->compact.renumbered(impl_->method->invertBlocks());
  return status;
}

bool BlockSolver::isExact() const {
  if (impl_->method) return impl_->method->isExact();
  return impl_->options.method != BlockSolverOptions::Method::conjugate_gradients;
}
const VectorXd& BlockSolver::gradient() const { return impl_->equations.gradient(); }
const VectorXd& BlockSolver::diagonal() const { return impl_->equations.diagonal(); }
double BlockSolver::squaredNormOfJd(const VectorXd& d) const { return impl_->equations.squaredNormOfJd(d); }
double BlockSolver::flops() const { return impl_->method ? impl_->method->flops() : 0; }

std::string BlockSolver::description() const {
  return impl_->method ? impl_->method->description() : "block solver that has solved nothing yet";
}

namespace {

template <BlockSolverOptions::Method method>
std::unique_ptr<LinearSolver> makeBlockSolver() {
  return std::make_unique<BlockSolver>(BlockSolverOptions{.method = method});
}

}  // namespace

const NamedSolver detail::solvers::automatic{"auto", "chosen by predicted cost", &makeSolver<BlockSolver>};
const NamedSolver detail::solvers::cholesky{"cholesky", "Cholesky decomposition of J^T J in blocks",
                                            &makeBlockSolver<BlockSolverOptions::Method::cholesky>};
const NamedSolver detail::solvers::conjugate_gradients{
    "cg", "conjugate gradients", &makeBlockSolver<BlockSolverOptions::Method::conjugate_gradients>};

}  // namespace slom
