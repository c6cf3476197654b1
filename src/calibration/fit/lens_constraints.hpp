// The constraints of Settings::lens, in terms of the estimator.
#pragma once

#include <string>

#include <slom/slom.hpp>

#include "calibration/models/lens.hpp"
#include "slom/calibration/options.hpp"

namespace slom::calibration {

/// Returns the lens of a camera with fixed parameters at their values and bounded ones within their bounds.
Lens constrained(Lens lens, const std::string& camera, const Settings& settings);

/// Fixes and bounds components of a variable whose value comes from constrained().
void constrain(Estimator& estimator, const VarID<Lens>& id, const std::string& camera,
               const Settings& settings);

/// Inserts the prior of Settings::sigma_denominator, with this sigma, if the model has one.
void addPrior(Estimator& estimator, const VarID<Lens>& id, double sigma);

/// Returns whether a model can trade some of its parameters against others, so that they diverge together. Then a
/// prior keeps them near 0.
bool hasPrior(const Model& model);

}  // namespace slom::calibration
