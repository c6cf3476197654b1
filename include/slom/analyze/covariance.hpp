/// How sure the estimated values are: blocks of (J^T J)^-1 at the current values, for the stated uncertainties.
#pragma once

#include <memory>

#include <Eigen/Core>

#include "slom/analyze/uncertainty.hpp"
#include "slom/optimize/system.hpp"

namespace slom {

/// Covariance between two variables (table indices), dof_a x dof_b, in their tangent spaces; 0 for fixed variables.
/// Throws [slom.free-gauge], [slom.rank-deficient] or [slom.unmeasured-variable].
Eigen::MatrixXd covarianceBlock(System& system, Linearizer& linearizer, FreeGauge gauge, int variable_a,
                                int variable_b);

/// Covariance of all unknowns. Throws likewise.
Eigen::MatrixXd covarianceOfAll(System& system, Linearizer& linearizer, FreeGauge gauge);

/// Makes the rows and columns of fixed components, and of those at a bound, 0 in the covariance of two variables.
void clearHeld(const Problem& problem, int variable_a, int variable_b, double* block);

/// All blocks of variables by themselves and of those that meet in a measurement. Throws likewise.
std::unique_ptr<InverseBlocks> inverseBlocks(System& system, Linearizer& linearizer, FreeGauge gauge);

/// Blocks of all variables by themselves, times the variance factor. Throws likewise.
Marginals makeMarginals(System& system, Linearizer& linearizer, FreeGauge gauge, double variance_factor);

}  // namespace slom
