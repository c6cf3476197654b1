/// The problem linearised at one point, as a value. All analyses of a fit use it.
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

/// Residuals r and the Jacobian J by measurement and block, both reweighted by losses; H = J^T J; and results derived
/// from them: the factor of H, the blocks of H^-1, the near-null space, the diagnosis. Each result is computed at the
/// first request and kept. Its users cannot change it. It is valid while isCurrent().
///
/// The optimisation loop does not make a LinearizedProblem for each step. It needs no rows, so they go straight into H
/// (docs/decisions/linearized_problem.md).
class [[gnu::visibility("hidden")]] LinearizedProblem {  // declared in a public header, not exported
 public:
  /// Linearises at the first request. `evaluator` lends its solver.
  LinearizedProblem(const Problem& problem, Evaluator& evaluator);
  ~LinearizedProblem();
  /// Returns whether structure and values are still those at construction.
  bool isCurrent() const;

  const Problem& problem() const { return problem_; }
  const ProblemStructure& structure() const { return structure_; }
  /// Returns the active set, including the bounds that are active at this point.
  const ActiveSet& activeSet() const;
  /// Returns the number of unknowns that are neither fixed nor at an active bound.
  int freeUnknowns() const;

  double rss() const;
  /// Returns the rows reweighted by losses. Columns of components that are fixed or at an active bound are 0.
  const JacobianRows& rows() const;
  /// Returns the rows before losses reweighted them, only of groups with losses.
  const JacobianRows& unweightedRows() const;
  /// Returns g = J^T r.
  const Eigen::VectorXd& gradient() const;
  /// Returns the diagonal of H.
  const Eigen::VectorXd& diagonal() const;
  /// Returns J V, including the rows of the group that holds components.
  Eigen::MatrixXd times(const Eigen::MatrixXd& V) const;
  /// See Evaluator::orthogonality.
  double orthogonality() const;
  /// See Evaluator::digitsOfDerivatives.
  double digitsOfDerivatives() const { return Evaluator::digitsOfDerivatives(problem_); }

  /// Solves H X = B with the estimator's solver, or with a more careful one if that solver finds a loss of rank.
  SolveStatus solveFor(const Eigen::MatrixXd& B, Eigen::MatrixXd& X) const;
  /// Returns whether solutions are exact, so that a loss of rank is detected.
  bool isExact() const;
  /// Returns `count` columns from `first` on of H^-1, or of the pseudo-inverse for a free gauge with inner constraints.
  Eigen::MatrixXd covarianceColumns(FreeGauge gauge, int first, int count) const;
  /// Returns whether J is factorised for a variance inflation (H^-1)_ii H_ii as large as this. It costs the normal equations
  /// as many digits.
  bool needsMoreDigits(double inflation) const;
  /// Returns the inverse of covarianceColumns() times B.
  Eigen::MatrixXd covarianceTimes(FreeGauge gauge, const Eigen::MatrixXd& B) const;
  /// Returns blocks of the inverse. Throws, as covarianceColumns() and covarianceTimes() do, [slom.free-gauge],
  /// [slom.rank-deficient] or [slom.unmeasured-variable].
  const InverseBlocks& inverse(FreeGauge gauge) const;
  /// Returns the blocks of the inverse if inverse() has computed them for this gauge, otherwise null.
  const InverseBlocks* knownInverse(FreeGauge gauge) const;
  /// Returns whether the solver finds H^-1.
  bool hasInverse() const;

  /// Returns the directions of least influence, including all with an influence below kNearNull.
  const NearNullSpace& nearNullSpace() const;
  /// Returns the dimension of the null space of J; 0 if the solver finds a unique solution.
  int freeDirections() const;
  const Diagnosis& diagnosis() const;
  /// Returns the error of an analysis that needs full rank: [slom.free-gauge] with the free motions, or singularError
  /// if the gauge is not the cause.
  Error undetermined(const SolveStatus& status) const;

 private:
  struct Results;
  void linearize() const;
  LinearSolver& solver() const;
  SolveStatus lookAgain(SolveStatus status, bool& has_changed) const;
  bool becomeCareful() const;
  /// Returns blocks of H^-1; null if there is none, with the reason in `status`.
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
