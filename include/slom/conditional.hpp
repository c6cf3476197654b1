/// conditional: eliminates chosen variables and returns the information of their measurements on the remaining
/// variables (the Schur complement). Programs use it to join maps and to make submaps.
///
///     for (const slom::GaussianPrior& prior : slom::conditional(submap, inner_poses)) {
///       std::vector<slom::AnyVarID> same;  // of the joined map
///       for (const slom::AnyVarID& id : prior.variables()) same.push_back(counterpartOf(id));
///       joined.insertMeasurement(prior.over(same));
///     }
#pragma once

#include <vector>

#include "slom/estimator.hpp"
#include "slom/measurements/gaussian_prior.hpp"

namespace slom {

/// Returns the minimum, over the tangent vectors of `ids`, of all measurements that depend on `ids`. It is a function
/// of the variables that these measurements share with the rest: one prior for each set of them that the elimination
/// couples, linearised at the current values. Changes nothing; Estimator::marginalize replaces the variables and
/// measurements by these priors. Throws as Estimator::marginalize does.
std::vector<GaussianPrior> conditional(const Estimator& est, const std::vector<AnyVarID>& ids);

}  // namespace slom
