/// What every linear solver does: takes linearised measurements, solves for a step.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "slom/linearize/jacobian_sink.hpp"
#include "slom/linearize/structure.hpp"

namespace slom {

/// Whether the system could be solved and, if not, at which unknown the rank ran out.
struct [[nodiscard]] SolveStatus {
  bool ok = true;
  int unknown = -1;  ///< index of the unknown that the others already determine, or that nothing determines
  double pivot = 0;  ///< what was left of its diagonal entry, relative (0: nothing, 1: all)
  double least = 0;  ///< what must be left of a column of J, relative to its length; 0: not known
};

/// Time spent since construction [s].
struct SolverSeconds {
  double factorize = 0;
  double solve = 0;
};

/// Work done since construction.
struct SolverCounts {
  long analyses = 0;        ///< symbolic
  long factorizations = 0;  ///< with conjugate gradients: preconditioners
};

/// Blocks of H^-1. `block` writes that of two blocks of unknowns, dof_a x dof_b, column-major; it is there for every block
/// with itself and for two that meet in a measurement. May be called by several threads.
class InverseBlocks {
 public:
  virtual ~InverseBlocks() = default;
  /// Writes the block of H^-1 that belongs to blocks a and b, dof_a x dof_b, column-major.
  virtual void block(int a, int b, double* out) const = 0;
};

/// Finds d minimising |r + J d|^2 + sum_i damping_i d_i^2. H = J^T J and g = J^T r below.
class LinearSolver : public JacobianSink {
 public:
  /// Symbolic work; once per structure.
  virtual void analyze(const BlockStructure& structure) = 0;
  /// The same, given what has changed since the last time. What comes out does not depend on what was there before: a solver keeps of its
  /// work what it would do again.
  virtual void update(const BlockStructure& structure, const StructureChanges& changes) {
    static_cast<void>(changes);
    analyze(structure);
  }
  /// Writes `step` on success and leaves it untouched otherwise. `damping` is empty (none) or has an entry >= 0 for
  /// each unknown.
  virtual SolveStatus solve(const Eigen::VectorXd& damping, Eigen::VectorXd& step) = 0;
  /// False when the steps minimise only roughly; they still go downhill.
  virtual bool isExact() const { return true; }

  /// g, the gradient of 1/2 |r|^2.
  virtual const Eigen::VectorXd& gradient() const = 0;
  /// Diagonal of H.
  virtual const Eigen::VectorXd& diagonal() const = 0;
  /// |J d|^2
  virtual double squaredNormOfJd(const Eigen::VectorXd& d) const = 0;

  /// Factorises the undamped system and solves H X = B; B has a row for each unknown.
  virtual SolveStatus solveFor(const Eigen::MatrixXd& B, Eigen::MatrixXd& X) = 0;

  /// Factorises the undamped system and gives the blocks of H^-1 that InverseBlocks speaks of, by whole columns unless the
  /// solver knows better. The structure is that of the last `analyze`.
  virtual SolveStatus invertBlocks(const BlockStructure& structure, std::unique_ptr<InverseBlocks>& blocks);

  /// What the others must leave of a column of J, relative to its length, for a rank to be found; 0: it does not find out.
  virtual double leastOfColumn() const { return 0; }
  /// One that keeps the digits which this one loses by forming J^T J, for where it finds no rank; null: this one keeps them.
  /// `least` is that solver's leastOfColumn().
  virtual std::unique_ptr<LinearSolver> careful(double least) const;

  /// Another one with the same settings, which knows of nothing yet, for Estimator::clone(); null: there is none.
  virtual std::unique_ptr<LinearSolver> makeAnother() const;

  /// What it is, for the summary.
  virtual std::string description() const = 0;
  /// Where its time went.
  virtual const SolverSeconds& seconds() const { return seconds_; }
  /// How often it analysed and factorised.
  virtual const SolverCounts& counts() const { return counts_; }

 protected:
  SolverSeconds seconds_;
  SolverCounts counts_;
};

}  // namespace slom
