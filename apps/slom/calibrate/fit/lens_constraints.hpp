// What --fix and --bound say of camera parameters, as the estimator wants it.
#pragma once

#include <algorithm>
#include <string>

#include <slom/slom.hpp>

#include "calibrate/camera_models.hpp"
#include "calibrate/settings.hpp"

namespace slom::app::calib {

/// Index of a parameter in the model, which has it.
template <class Camera>
int indexOf(const std::string& parameter) {
  const auto& names = Camera::component_names;
  return static_cast<int>(std::find(names.begin(), names.end(), parameter) - names.begin());
}

/// The camera with fixed parameters at their values and bounded ones within their bounds.
template <class Camera>
Camera constrained(Camera camera, const std::string& name, const Settings& settings) {
  for (const LensConstraint& constraint : settings.lens) {
    if (!constraint.concerns(name)) continue;
    double& x = camera[indexOf<Camera>(constraint.parameter)];
    x = std::clamp(x, constraint.lower, constraint.upper);
  }
  return camera;
}

/// Fixes and bounds components of a variable whose value is `constrained`.
template <class Camera>
void constrain(Estimator& estimator, const VarID<Camera>& id, const std::string& name,
               const Settings& settings) {
  for (const LensConstraint& constraint : settings.lens) {
    if (!constraint.concerns(name)) continue;
    if (constraint.isFixed()) {
      estimator.fix(id, constraint.parameter);
    } else {
      estimator.bound(id, constraint.parameter, constraint.lower, constraint.upper);
    }
  }
}

/// The prior of Settings::sigma_denominator, with this sigma.
template <class Camera>
void keepDenominatorNearZero(Estimator& estimator, const VarID<Camera>& id, double sigma) {
  if constexpr (has_denominator<Camera>) {
    estimator.insertMeasurement(
        [](const auto& camera) { return mtk::vector(camera[9], camera[10], camera[11]); }, id,
        StandardDeviation(sigma), named("prior of k4, k5, k6"));
  }
}

}  // namespace slom::app::calib
