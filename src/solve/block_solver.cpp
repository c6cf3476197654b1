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
    throw mtk::Error(
        "slom.bad-option",
        "forcing is " + std::to_string(options.forcing) + "; pass a number between 0 and 1, such as 0.1",
        "forcing");
  }
  if (options.max_iterations < 1) {
    throw mtk::Error("slom.bad-option",
                     "max_iterations of conjugate gradients is " + std::to_string(options.max_iterations) +
                         "; pass a positive number, such as 500",
                     "max_iterations");
  }
}

}  // namespace

struct BlockSolver::Implementation final : LinearSolver {
  explicit Implementation(const BlockSolverOptions& options) : options_(options) { check(options_); }

  void analyze(const BlockStructure& structure) override {
    ++counts_.analyses;
    choose(compact(structure));
  }

  /// Keeps order, fronts and plans if the same blocks meet as before.
  void update(const BlockStructure& structure, const StructureChanges& changes) override;

  void beginLinearization() override {
    ready().forget();
    equations_.setZero();
  }
  void add(const JacobianBatch& batch) override { equations_.add(batch); }
  std::span<const MeasurementPlace> partitions() const override { return equations_.partitions(); }
  void endLinearization() override { equations_.addUp(); }

  SolveStatus solve(const VectorXd& damping, VectorXd& step) override;
  SolveStatus solveFor(const MatrixXd& B, MatrixXd& X) override { return solveDamped({}, B, X); }
  SolveStatus solveDamped(const VectorXd& damping, const MatrixXd& B, MatrixXd& X);

  SolveStatus invertBlocks(const BlockStructure& structure, std::unique_ptr<InverseBlocks>& blocks) override {
    return isExact() ? invertDamped({}, blocks) : LinearSolver::invertBlocks(structure, blocks);
  }
  /// Selected inversion of the factor, which takes about as long as two more factorisations.
  ///   source   Takahashi, Fagan and Chen 1973; Campbell and Davis 1995
  SolveStatus invertDamped(const VectorXd& damping, std::unique_ptr<InverseBlocks>& blocks) {
    const SolveStatus status = prepare(damping);
    if (status.ok) blocks = compact_.renumbered(method_->invertBlocks());
    return status;
  }

  bool isExact() const override {
    return method_ ? method_->isExact() : options_.method != BlockSolverOptions::Method::conjugate_gradients;
  }
  const VectorXd& gradient() const override { return equations_.gradient(); }
  const VectorXd& diagonal() const override { return equations_.diagonal(); }
  double squaredNormOfJd(const VectorXd& d) const override { return equations_.squaredNormOfJd(d); }
  double leastOfColumn() const override { return isExact() ? std::sqrt(kPivotTolerance) : 0; }
  std::unique_ptr<LinearSolver> careful(double least) const override {
    return isExact() ? std::make_unique<BlockQR>(least) : nullptr;
  }
  const BlockSolverOptions& options() const { return options_; }
  double flops() const { return method_ ? method_->flops() : 0; }
  std::string description() const override {
    return method_ ? method_->description() : "block solver that has solved nothing yet";
  }

 private:
  void choose(CompactStructure now) {
    method_.reset();
    compact_ = std::move(now);
    method_ = chooseMethod(compact_.structure, options_, equations_);
  }

  BlockMethod& ready() {
    if (!method_)
      throw mtk::Error("slom.not-analyzed", "the block solver knows no structure yet; call analyze() first");
    return *method_;
  }

  SolveStatus prepare(const VectorXd& damping, VectorXd* x = nullptr) {
    const long before = ready().preparations();
    const SolveStatus status = method_->prepare(damping, x);
    counts_.factorizations += method_->preparations() - before;
    return status;
  }

  BlockSolverOptions options_;
  CompactStructure compact_;
  NormalEquations equations_;
  std::unique_ptr<BlockMethod> method_;  // null before analyze()
};

void BlockSolver::Implementation::update(const BlockStructure& structure, const StructureChanges& changes) {
  if (changes.blocks || !method_) return analyze(structure);
  CompactStructure now = compact(structure);
  if (changes.meetings && makeGraph(now.structure) != makeGraph(compact_.structure)) {
    ++counts_.analyses;
    return choose(std::move(now));
  }
  std::unique_ptr<BlockMethod> kept = std::move(method_);  // lost if memory runs out below
  compact_ = std::move(now);
  equations_.layOutMeasurements();
  kept->forget();
  method_ = std::move(kept);
}

SolveStatus BlockSolver::Implementation::solve(const VectorXd& damping, VectorXd& step) {
  VectorXd x = -gradient();
  SolveStatus status;
  {
    const detail::Stopwatch watch(seconds_.factorize);
    status = prepare(damping, &x);
  }
  if (!status.ok) return status;
  const detail::Stopwatch watch(seconds_.solve);
  status = method_->solveStep(x);
  if (status.ok) step = std::move(x);
  return status;
}

SolveStatus BlockSolver::Implementation::solveDamped(const VectorXd& damping, const MatrixXd& B,
                                                     MatrixXd& X) {
  SolveStatus status = prepare(damping);
  if (!status.ok) return status;
  MatrixXd all = B;
  status = method_->solveColumns(all);
  if (status.ok) X = std::move(all);
  return status;
}

BlockSolver::BlockSolver(const BlockSolverOptions& options)
    : ForwardingSolver(std::make_unique<Implementation>(options)) {}

SolveStatus BlockSolver::solveDamped(const VectorXd& damping, const MatrixXd& B, MatrixXd& X) {
  return static_cast<Implementation&>(solver()).solveDamped(damping, B, X);
}

SolveStatus BlockSolver::invertDamped(const VectorXd& damping, std::unique_ptr<InverseBlocks>& blocks) {
  return static_cast<Implementation&>(solver()).invertDamped(damping, blocks);
}

std::unique_ptr<LinearSolver> BlockSolver::makeAnother() const {
  return std::make_unique<BlockSolver>(static_cast<const Implementation&>(solver()).options());
}

double BlockSolver::flops() const { return static_cast<const Implementation&>(solver()).flops(); }

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
