/// How sure the estimated values are: blocks of (J^T J)^-1 at the current values, for the stated uncertainties.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "slom/optimize/system.hpp"

namespace slom {

/// Covariance between two variables (table indices) in their tangent spaces, dof_a x dof_b; 0 where one is fixed.
/// Throws [slom.rank-deficient] or [slom.unmeasured-variable].
Eigen::MatrixXd covarianceBlock(System& system, int variable_a, int variable_b);

/// Covariance of each block of unknowns by itself, one after the other. Throws likewise.
void marginalBlocks(System& system, std::vector<double>& blocks);

}  // namespace slom
