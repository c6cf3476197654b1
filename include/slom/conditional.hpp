/// What the measurements of some variables say about the others: the Schur complement of a chosen set, for joining maps and for submaps.
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

/// The minimum over the tangent vectors of `ids` of all measurements that depend on them, as a function of the variables that these
/// measurements share with the rest: one prior for each set of them that remains in touch, linearised at the current values. Changes
/// nothing; Estimator::marginalize puts these priors in the place of the variables and measurements. Throws what that throws.
std::vector<GaussianPrior> conditional(const Estimator& est, const std::vector<AnyVarID>& ids);

}  // namespace slom
