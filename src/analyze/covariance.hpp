/// How sure the estimated values are: blocks of (J^T J)^-1, for the stated uncertainties.
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

#include "analyze/linearized_problem.hpp"

namespace slom {

/// Covariance between two variables (table indices), dof_a x dof_b, in their tangent spaces; 0 for fixed variables, components, and
/// those at a bound. Throws [slom.free-gauge], [slom.rank-deficient] or [slom.unmeasured-variable].
Eigen::MatrixXd covarianceBlock(const LinearizedProblem& linearized, FreeGauge gauge, int variable_a,
                                int variable_b);

/// The same of several variables together, one after the other.
Eigen::MatrixXd jointCovariance(const LinearizedProblem& linearized, FreeGauge gauge,
                                const std::vector<int>& variables);

/// Makes the rows and columns of fixed components, and of those at a bound, 0 in the covariance of two variables.
void clearConstrained(const LinearizedProblem& linearized, int variable_a, int variable_b, double* block);

/// Blocks of all variables by themselves, times the variance factor. `write` writes that of a variable, dof x dof, or returns false for one
/// that is certain.
Marginals makeMarginals(const Problem& problem, const std::function<bool(int variable, double* block)>& write,
                        double variance_factor);
/// The same of the linearised problem. Throws as covarianceBlock() does.
Marginals makeMarginals(const LinearizedProblem& linearized, FreeGauge gauge, double variance_factor);

}  // namespace slom
