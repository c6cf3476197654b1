#include "calibration/fit/lens_constraints.hpp"

#include <algorithm>
#include <utility>

#include "calibration/models/definition.hpp"

namespace slom::calibration {

Lens constrained(Lens lens, const std::string& camera, const Settings& settings) {
  const std::vector<std::string>& names = lens.componentNames();
  for (const LensConstraint& constraint : settings.lens) {
    if (!constraint.concerns(camera)) continue;
    const auto index = std::find(names.begin(), names.end(), constraint.parameter) - names.begin();
    lens[index] = std::clamp(lens[index], constraint.lower, constraint.upper);
  }
  return lens;
}

void constrain(Estimator& estimator, const VarID<Lens>& id, const std::string& camera,
               const Settings& settings) {
  for (const LensConstraint& constraint : settings.lens) {
    if (!constraint.concerns(camera)) continue;
    if (constraint.isFixed()) {
      estimator.fix(id, constraint.parameter);
    } else {
      estimator.bound(id, constraint.parameter, constraint.lower, constraint.upper);
    }
  }
}

bool hasPrior(const Model& model) { return !model.definition().held_near_zero.empty(); }

void addPrior(Estimator& estimator, const VarID<Lens>& id, double sigma) {
  for (const std::string& name : id->model().heldNearZero())
    estimator.prior(id, name, 0.0, StandardDeviation(sigma));
}

}  // namespace slom::calibration
