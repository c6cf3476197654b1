/// Covariances of estimated values: blocks of (J^T J)^-1, for the stated uncertainties.
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

#include "analyze/linearized_problem.hpp"

namespace slom {

/// Returns the covariance between two variables (table indices), dof_a x dof_b, in their tangent spaces. Entries of
/// fixed variables, fixed components and components at a bound are 0. Throws [slom.free-gauge], [slom.rank-deficient]
/// or [slom.unmeasured-variable].
Eigen::MatrixXd covarianceBlock(const LinearizedProblem& linearized, FreeGauge gauge, int variable_a,
                                int variable_b);

/// Returns the joint covariance of several variables, stacked in this order. Reads it from the blocks of the inverse, if
/// these have been computed and a measurement depends on all the variables. Throws as covarianceBlock() does.
Eigen::MatrixXd jointCovariance(const LinearizedProblem& linearized, FreeGauge gauge,
                                const std::vector<int>& variables);

/// Sets to 0, in the covariance of two variables, the rows and columns of fixed components and of components at a
/// bound.
void clearConstrained(const LinearizedProblem& linearized, int variable_a, int variable_b, double* block);

/// Collects the diagonal blocks of all variables, times the variance factor. `write` writes the block of a variable,
/// dof x dof, or returns false for a variable without uncertainty.
Marginals makeMarginals(const Problem& problem, const std::function<bool(int variable, double* block)>& write,
                        double variance_factor);
/// Collects the diagonal blocks of all variables of the linearised problem. Throws as covarianceBlock() does.
Marginals makeMarginals(const LinearizedProblem& linearized, FreeGauge gauge, double variance_factor);

}  // namespace slom
