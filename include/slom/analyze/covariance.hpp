/// How sure the estimated values are: blocks of (J^T J)^-1 at the current values, for the stated uncertainties.
#pragma once

#include <memory>

#include <Eigen/Core>

#include "slom/optimize/system.hpp"

namespace slom {

/// Covariance between two variables (table indices) in their tangent spaces, dof_a x dof_b; 0 where one is fixed.
/// Throws [slom.free-gauge],
/// [slom.rank-deficient] or [slom.unmeasured-variable].
Eigen::MatrixXd covarianceBlock(System& system, Linearizer& linearizer, int variable_a, int variable_b);

/// All blocks of variables by themselves and of those that meet in a measurement. Throws likewise.
std::unique_ptr<InverseBlocks> inverseBlocks(System& system, Linearizer& linearizer);

}  // namespace slom
