/// The problem linearised at one point, as a value: what all analyses of a fit look at.
#pragma once

#include <cstdint>
#include <memory>

#include <Eigen/Core>

#include "slom/analyze/diagnosis.hpp"
#include "slom/analyze/uncertainty.hpp"
#include "slom/optimize/evaluator.hpp"
#include "solve/block/jacobian_rows.hpp"

namespace slom {

class FreeNetwork;
struct NearNullSpace;

/// Residuals r and the Jacobian J by measurement and block, where losses have reweighted both, H = J^T J, and what follows from them:
/// the factor of H, the blocks of H^-1, the near-null space, the diagnosis. Each is computed when it is first asked for, and kept.
/// Nothing that its users do changes it. It is valid while isCurrent().
///
/// The optimisation loop does not make one for each step, as it needs no rows: there they go straight into H
/// (docs/decisions/linearized_problem.md).
class [[gnu::visibility("hidden")]] LinearizedProblem {  // declared in a public header, not exported
 public:
  /// Linearises when something is first asked for. `system` lends its solver.
  LinearizedProblem(const Problem& problem, Evaluator& evaluator);
  ~LinearizedProblem();
  /// Whether structure and values are those that it was made of.
  bool isCurrent() const;

  const Problem& problem() const { return problem_; }
  const ProblemStructure& structure() const { return structure_; }
  /// The active set, with the bounds that are active at this point.
  const ActiveSet& activeSet() const;
  /// Number of unknowns that are neither fixed nor at an active bound.
  int freeUnknowns() const;

  double rss() const;
  /// Reweighted by losses; the columns of components that are fixed or at an active bound are 0.
  const JacobianRows& rows() const;
  /// The rows before losses reweighted them, of groups with losses only.
  const JacobianRows& unweightedRows() const;
  /// g = J^T r
  const Eigen::VectorXd& gradient() const;
  /// Diagonal of H.
  const Eigen::VectorXd& diagonal() const;
  /// J V, the rows of the group that holds components included.
  Eigen::MatrixXd times(const Eigen::MatrixXd& V) const;
  /// See Evaluator::orthogonality.
  double orthogonality() const;
  /// See Evaluator::digitsOfDerivatives.
  double digitsOfDerivatives() const { return Evaluator::digitsOfDerivatives(problem_); }

  /// Solves H X = B with the estimator's solver, and by a more careful one where that finds no rank.
  SolveStatus solveFor(const Eigen::MatrixXd& B, Eigen::MatrixXd& X) const;
  /// Whether a solution is exact, and a loss of rank noticed.
  bool isExact() const;
  /// `count` columns of H^-1 (or, for a free gauge with inner constraints, of the pseudo-inverse) from `first` on.
  Eigen::MatrixXd covarianceColumns(FreeGauge gauge, int first, int count) const;
  /// The same inverse times B.
  Eigen::MatrixXd covarianceTimes(FreeGauge gauge, const Eigen::MatrixXd& B) const;
  /// Blocks of it. This and the above throw [slom.free-gauge], [slom.rank-deficient] or [slom.unmeasured-variable].
  const InverseBlocks& inverse(FreeGauge gauge) const;
  /// Whether the solver finds H^-1.
  bool hasInverse() const;

  /// Directions whose influence is below kNearNull at the least.
  const NearNullSpace& nearNullSpace() const;
  /// Dimension of the null space of J: 0 where the solver finds a unique solution.
  int freeDirections() const;
  const Diagnosis& diagnosis() const;
  /// The error of an analysis that needs full rank: [slom.free-gauge] with the motions that are free or, where that is not the
  /// cause, singularError.
  Error undetermined(const SolveStatus& status) const;

 private:
  struct Results;
  void linearize() const;
  LinearSolver& solver() const;
  SolveStatus lookAgain(SolveStatus status, bool& has_changed) const;
  bool becomeCareful() const;
  /// Blocks of H^-1; null, with the reason, where there is none.
  const InverseBlocks* findInverse(SolveStatus& status) const;
  double largestInflation(const InverseBlocks& inverse) const;
  const FreeNetwork& freeNetwork() const;

  const Problem& problem_;
  Evaluator& evaluator_;
  const ProblemStructure& structure_;
  std::uint64_t structure_revision_, value_revision_;
  std::unique_ptr<Results> results_;
};

}  // namespace slom
