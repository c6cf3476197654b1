/// ForwardingSolver: a solver that passes its work to another one.
#pragma once

#include <memory>

#include "slom/solve/linear_solver.hpp"

namespace slom {

/// Passes every call on. The solvers of the library derive from it, so each of their headers shows only what is
/// specific. Derive from it to observe or change a few calls of any solver.
class ForwardingSolver : public LinearSolver {
 public:
  /// Sets the solver that receives the calls. Throws [slom.no-solver] for a null pointer.
  explicit ForwardingSolver(std::unique_ptr<LinearSolver> solver);

  void analyze(const BlockStructure& structure) override;
  void update(const BlockStructure& structure, const StructureChanges& changes) override;
  void beginLinearization() override;
  void add(const JacobianBatch& batch) override;
  bool wantsUnweighted() const override;
  void addUnweighted(const JacobianBatch& batch) override;
  std::span<const MeasurementPlace> partitions() const override;
  void endLinearization() override;
  void completeLinearization() override;
  const Collective& collective() const override;
  SolveStatus solve(const Eigen::VectorXd& damping, Eigen::VectorXd& step) override;
  bool isExact() const override;
  const Eigen::VectorXd& gradient() const override;
  const Eigen::VectorXd& diagonal() const override;
  double squaredNormOfJd(const Eigen::VectorXd& d) const override;
  SolveStatus solveFor(const Eigen::MatrixXd& B, Eigen::MatrixXd& X) override;
  SolveStatus invertBlocks(const BlockStructure& structure, std::unique_ptr<InverseBlocks>& blocks) override;
  double leastOfColumn() const override;
  std::unique_ptr<LinearSolver> careful(double least) const override;
  std::string description() const override;
  const SolverSeconds& seconds() const override;
  const SolverCounts& counts() const override;

 protected:
  LinearSolver& solver() { return *solver_; }
  const LinearSolver& solver() const { return *solver_; }

 private:
  std::unique_ptr<LinearSolver> solver_;
};

}  // namespace slom
