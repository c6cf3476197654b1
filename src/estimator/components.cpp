// Variance components of a fit, and the functions that apply them.
#include "analyze/variance/estimate_components.hpp"
#include "base/index.hpp"
#include "base/words.hpp"
#include "estimator/state.hpp"
#include "slom/analyze/variance_components.hpp"

namespace slom {

VarianceComponents Estimator::varianceComponents() const { return varianceComponents(VarianceOptions{}); }

VarianceComponents Estimator::varianceComponents(const VarianceOptions& options) const {
  if (!(options.max_iterations > 0 && options.tolerance > 0)) {
    throw Error("slom.bad-option",
                "max_iterations is " + std::to_string(options.max_iterations) + " and the tolerance " +
                    number(options.tolerance, 6) + "; pass positive numbers, such as 200 and 1e-9",
                "VarianceOptions");
  }
  if (!state_->isAtMinimum(1)) {
    throw Error("slom.not-a-minimum",
                "variance components need the values of a converged fit; call optimize() and check "
                "summary.converged",
                "varianceComponents");
  }
  return state_->analyze([&](const LinearizedProblem& linearized) {
    return estimateComponents(linearized, state_->gauge, options);
  });
}

void Estimator::apply(const VarianceComponents& components) {
  const VarianceComponents::Assignment* const to = components.assignment.get();
  if (to == nullptr || to->problem != &problem() || to->structure_revision != problem().structureRevision()) {
    throw Error("slom.stale-components",
                "the variance components belong to a problem that has changed, or to another problem; call "
                "varianceComponents() again",
                "VarianceComponents");
  }
  std::vector<std::vector<double>> factors;
  for (const std::vector<int>& of : to->of_pool) {
    std::vector<double>& own = factors.emplace_back(of.size(), 1.0);
    for (std::size_t i = 0; i < of.size(); ++i) {
      if (of[i] < 0) continue;
      const VarianceComponent& component = components.components[at(of[i])];
      if (component.is_estimated) own[i] = component.factor;
    }
  }
  state_->current.reset();
  problem().scaleSigmas(factors);
}

}  // namespace slom
