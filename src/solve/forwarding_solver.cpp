#include "slom/solve/forwarding_solver.hpp"

#include "mtk/error.hpp"

namespace slom {

using Eigen::MatrixXd;
using Eigen::VectorXd;

ForwardingSolver::ForwardingSolver(std::unique_ptr<LinearSolver> solver) : solver_(std::move(solver)) {
  if (!solver_) {
    throw mtk::Error("slom.no-solver",
                     "ForwardingSolver got a null pointer; pass a BlockSolver, BlockQR or DenseQR",
                     "ForwardingSolver");
  }
}

void ForwardingSolver::analyze(const BlockStructure& structure) { solver_->analyze(structure); }
void ForwardingSolver::update(const BlockStructure& structure, const StructureChanges& changes) {
  solver_->update(structure, changes);
}

void ForwardingSolver::beginLinearization() { solver_->beginLinearization(); }
void ForwardingSolver::add(const JacobianBatch& batch) { solver_->add(batch); }
bool ForwardingSolver::wantsUnweighted() const { return solver_->wantsUnweighted(); }
void ForwardingSolver::addUnweighted(const JacobianBatch& batch) { solver_->addUnweighted(batch); }
std::span<const MeasurementPlace> ForwardingSolver::partitions() const { return solver_->partitions(); }
void ForwardingSolver::endLinearization() { solver_->endLinearization(); }
void ForwardingSolver::completeLinearization() { solver_->completeLinearization(); }
const Collective& ForwardingSolver::collective() const { return solver_->collective(); }

SolveStatus ForwardingSolver::solve(const VectorXd& damping, VectorXd& step) {
  return solver_->solve(damping, step);
}
SolveStatus ForwardingSolver::solveFor(const MatrixXd& B, MatrixXd& X) { return solver_->solveFor(B, X); }
SolveStatus ForwardingSolver::invertBlocks(const BlockStructure& structure,
                                           std::unique_ptr<InverseBlocks>& blocks) {
  return solver_->invertBlocks(structure, blocks);
}

bool ForwardingSolver::isExact() const { return solver_->isExact(); }
const VectorXd& ForwardingSolver::gradient() const { return solver_->gradient(); }
const VectorXd& ForwardingSolver::diagonal() const { return solver_->diagonal(); }
double ForwardingSolver::squaredNormOfJd(const VectorXd& d) const { return solver_->squaredNormOfJd(d); }
double ForwardingSolver::leastOfColumn() const { return solver_->leastOfColumn(); }
std::unique_ptr<LinearSolver> ForwardingSolver::careful(double least) const {
  return solver_->careful(least);
}

std::string ForwardingSolver::description() const { return solver_->description(); }
const SolverSeconds& ForwardingSolver::seconds() const { return solver_->seconds(); }
const SolverCounts& ForwardingSolver::counts() const { return solver_->counts(); }

}  // namespace slom
