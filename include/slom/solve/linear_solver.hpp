/// LinearSolver: the interface of all linear solvers. It takes linearised measurements and solves for a step.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "slom/base/collective.hpp"
#include "slom/linearize/jacobian_sink.hpp"
#include "slom/linearize/structure.hpp"

namespace slom {

/// Whether the system could be solved and, if not, the unknown at which the rank ended.
struct [[nodiscard]] SolveStatus {
  bool ok = true;
  int unknown = -1;  ///< index of the unknown that the others already determine, or that nothing determines
  double pivot = 0;  ///< remainder of its diagonal entry, relative (0: nothing, 1: all)
  double least = 0;  ///< required remainder of a column of J, relative to its length; 0: not known
};

/// Time spent since construction [s].
struct SolverSeconds {
  double factorize = 0;
  double solve = 0;
};

/// Work done since construction.
struct SolverCounts {
  long analyses = 0;        ///< symbolic analyses
  long factorizations = 0;  ///< with conjugate gradients: number of preconditioners
};

/// Blocks of H^-1, for every block with itself and for two blocks that meet in a measurement. Several threads may call
/// the functions.
class InverseBlocks {
 public:
  virtual ~InverseBlocks() = default;
  /// Writes the block of H^-1 for blocks a and b, dof_a x dof_b, column-major.
  virtual void block(int a, int b, double* out) const = 0;
};

/// Finds d that minimises |r + J d|^2 + sum_i damping_i d_i^2. Below, H = J^T J and g = J^T r.
class LinearSolver : public JacobianSink {
 public:
  /// Does the symbolic work, once for each structure.
  virtual void analyze(const BlockStructure& structure) = 0;
  /// Updates the symbolic work, given the changes since the last time. The result must not depend on earlier
  /// structures: a solver may reuse only work that it would repeat identically.
  virtual void update(const BlockStructure& structure, const StructureChanges& changes) {
    static_cast<void>(changes);
    analyze(structure);
  }
  /// Adds what other processes have linearised. Called after endLinearization(), in all processes. From then on,
  /// gradient() and diagonal() cover the whole problem.
  virtual void completeLinearization() {}
  /// Returns the processes that solve together. By default there is only this one.
  virtual const Collective& collective() const { return singleProcess(); }
  /// Writes `step` on success and leaves it unchanged otherwise. `damping` is empty (none) or has an entry >= 0 for
  /// each unknown.
  virtual SolveStatus solve(const Eigen::VectorXd& damping, Eigen::VectorXd& step) = 0;
  /// Returns false if the steps minimise only approximately. Such steps still lead downhill.
  virtual bool isExact() const { return true; }

  /// Returns g, the gradient of 1/2 |r|^2.
  virtual const Eigen::VectorXd& gradient() const = 0;
  /// Returns the diagonal of H.
  virtual const Eigen::VectorXd& diagonal() const = 0;
  /// Returns |J d|^2.
  virtual double squaredNormOfJd(const Eigen::VectorXd& d) const = 0;

  /// Factorises the undamped system and solves H X = B; B has a row for each unknown.
  virtual SolveStatus solveFor(const Eigen::MatrixXd& B, Eigen::MatrixXd& X) = 0;

  /// Factorises the undamped system and gives the blocks of H^-1 (InverseBlocks). The default computes whole columns.
  /// The structure is that of the last `analyze`.
  virtual SolveStatus invertBlocks(const BlockStructure& structure, std::unique_ptr<InverseBlocks>& blocks);

  /// Returns the fraction of the length of a column of J that must remain beside the other columns for full rank; 0:
  /// the solver does not detect a loss of rank.
  virtual double leastOfColumn() const { return 0; }
  /// Returns a solver that keeps the digits which this solver loses by forming J^T J, to use if this one finds no full
  /// rank. Null: this solver keeps them. `least` is leastOfColumn() of the returned solver.
  virtual std::unique_ptr<LinearSolver> careful(double least) const;

  /// Returns a new solver with the same settings, without data, for Estimator::clone(); null if there is none.
  virtual std::unique_ptr<LinearSolver> makeAnother() const;

  /// Returns a description for the summary.
  virtual std::string description() const = 0;
  /// Returns the time spent.
  virtual const SolverSeconds& seconds() const { return seconds_; }
  /// Returns how often the solver analysed and factorised.
  virtual const SolverCounts& counts() const { return counts_; }

 protected:
  SolverSeconds seconds_;
  SolverCounts counts_;
};

}  // namespace slom
