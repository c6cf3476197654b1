// What --fix and --bound say of camera parameters, as the estimator wants it.
#pragma once

#include <algorithm>
#include <string>
#include <utility>

#include <slom/slom.hpp>

#include "calibration/models/camera.hpp"
#include "slom/calibration/options.hpp"

namespace slom::calibration {

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

/// Whether a model can trade some of its parameters against others, so that these run off together: a prior then keeps them near 0.
template <class Camera>
inline constexpr bool has_prior = requires { Camera::held_near_zero; };

/// The prior of Settings::sigma_denominator, with this sigma, for models that have one.
template <class Camera>
void addPrior(Estimator& estimator, const VarID<Camera>& id, double sigma) {
  if constexpr (has_prior<Camera>) {
    std::string names;
    for (const int i : Camera::held_near_zero)
      names += (names.empty() ? "" : ", ") + std::string(Camera::component_names[i]);
    const auto parameters = [](const auto& camera) {
      return [&]<std::size_t... i>(std::index_sequence<i...>) {
        return mtk::vector(camera[Camera::held_near_zero[i]]...);
      }(std::make_index_sequence<Camera::held_near_zero.size()>());
    };
    estimator.insertMeasurement(parameters, id, StandardDeviation(sigma), named("prior of " + names));
  }
}

}  // namespace slom::calibration
