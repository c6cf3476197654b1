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

/// All blocks of variables by themselves and of those that meet in a measurement. Throws likewise.
std::unique_ptr<InverseBlocks> inverseBlocks(System& system, Linearizer& linearizer, FreeGauge gauge);

}  // namespace slom
