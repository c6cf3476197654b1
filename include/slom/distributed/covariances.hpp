/// Covariances: of chosen variables, after a fit on several processes.
#pragma once

#include <map>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "slom/analyze/uncertainty.hpp"
#include "slom/distributed/petsc_solver.hpp"
#include "slom/estimator.hpp"
#include "slom/linearize/structure.hpp"

namespace slom::distributed {

/// Covariances of the variables that each process asks for, by solutions with columns of the identity. They equal
/// Estimator::covariance of a single process that has all measurements: at the current values, with the weights of
/// losses, 0 for fixed components.
///
///     const slom::distributed::Covariances covariances(est, *solver, {pose, landmark});
///     covariances.standardDeviation(pose);
///
/// The time is that of a solution for each degree of freedom that any process asks for.
class Covariances {
 public:
  /// Linearises and solves. All processes call it, each with variables of its own estimator, or with none. `solver`: of
  /// the estimator. If a variable is shared, one process is enough to ask for it. Throws in all processes:
  /// [slom.rank-deficient] if the measurements do not determine all unknowns, or if conjugate gradients do not find a
  /// column; [slom.no-unknowns] for a variable without measurements in the process that asks;
  /// [slom.no-redundancy] with Sigma::estimated, unless there are more residuals than unknowns; [slom.needs-all] with
  /// FreeGauge::inner_constraints.
  Covariances(const Estimator& est, PetscSolver& solver, const std::vector<AnyVarID>& ids);

  /// Returns the covariance of a variable in its tangent space (dof x dof). Throws [slom.not-asked] for a variable that
  /// was not passed to the constructor.
  template <AnyVariableHandle V>
  Eigen::MatrixXd covariance(const V& id) const {
    return covariance(id, id);
  }
  /// Returns the cross-covariance of two variables of this process (dof_a x dof_b). Throws [slom.not-asked].
  template <AnyVariableHandle A, AnyVariableHandle B>
  Eigen::MatrixXd covariance(const A& a, const B& b) const {
    return block(table_.indexOf(a), table_.indexOf(b));
  }
  /// Returns the standard deviation of each component. Throws [slom.not-asked].
  template <AnyVariableHandle V>
  Eigen::VectorXd standardDeviation(const V& id) const {
    return detail::deviations(covariance(id));
  }

 private:
  Eigen::MatrixXd block(int a, int b) const;
  void solveFor(PetscSolver& solver, const ProblemStructure& structure, const std::vector<int>& variables);
  double varianceFactor(const Estimator& est, const PetscSolver& solver, const ProblemStructure& structure,
                        double rss) const;

  const Problem& table_;
  std::map<int, int> first_;  // by variable: its first row in C_
  Eigen::MatrixXd C_;         // of the variables of this process
};

}  // namespace slom::distributed
