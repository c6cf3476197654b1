// Variance components of a fit, and the functions that apply them.
#include "analyze/variance/estimate_components.hpp"
#include "base/index.hpp"
#include "base/words.hpp"
#include "estimator/analysis_access.hpp"
#include "slom/analyze/variance_components.hpp"

namespace slom {

VarianceComponents varianceComponents(const Estimator& est) {
  return varianceComponents(est, VarianceOptions{});
}

VarianceComponents varianceComponents(const Estimator& est, const VarianceOptions& options) {
  if (!(options.max_iterations > 0 && options.tolerance > 0)) {
    throw Error("slom.bad-option",
                "max_iterations is " + std::to_string(options.max_iterations) + " and the tolerance " +
                    number(options.tolerance, 6) + "; pass positive numbers, such as 200 and 1e-9",
                "VarianceOptions");
  }
  EstimatorState& own = stateOf(est);
  if (!own.isAtMinimum(1)) {
    throw Error("slom.not-a-minimum",
                "variance components need the values of a converged fit; call optimize() and check "
                "summary.converged",
                "varianceComponents");
  }
  return own.analyze([&](const LinearizedProblem& linearized) {
    return estimateComponents(linearized, own.gauge, options);
  });
}

void apply(const VarianceComponents& components, Estimator& est) {
  EstimatorState& own = stateOf(est);
  const VarianceComponents::Assignment* const to = components.assignment.get();
  if (to == nullptr || to->problem != &own.problem ||
      to->structure_revision != own.problem.structureRevision()) {
    throw Error("slom.stale-components",
                "the variance components belong to a problem that has changed, or to another problem; call "
                "slom::varianceComponents(est) again",
                "VarianceComponents");
  }
  std::vector<std::vector<double>> factors;
  for (const std::vector<int>& of : to->of_pool) {
    std::vector<double>& pool = factors.emplace_back(of.size(), 1.0);
    for (std::size_t i = 0; i < of.size(); ++i) {
      if (of[i] < 0) continue;
      const VarianceComponent& component = components.components[at(of[i])];
      if (component.is_estimated) pool[i] = component.factor;
    }
  }
  own.current.reset();
  own.problem.scaleSigmas(factors);
}

}  // namespace slom
