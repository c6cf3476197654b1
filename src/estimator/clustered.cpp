// Clustered covariances of a fit.
#include "slom/analyze/clustered.hpp"

#include "analyze/clustered/clustered_state.hpp"
#include "base/index.hpp"
#include "estimator/analysis_access.hpp"

namespace slom {

/// Fits without each group of the first way, with the estimator's algorithm.
GroupRefits Estimator::State::refitGroups(const ClusterOptions& options) {
  if (gauge == FreeGauge::inner_constraints &&
      analyze([](const LinearizedProblem& linearized) { return linearized.freeDirections(); }) > 0) {
    throw Error("slom.bad-option",
                "ClusterOptions::refit compares the values of fits, which differ by a motion of everything "
                "while the gauge is free; fix the gauge, or drop refit",
                "refit");
  }
  const Clustering way = Clustered::State::firstWay(problem, options);
  const ProblemStructure structure = evaluator.structure();
  const auto fit = [&] {
    try {
      return optimize(*algorithm, Options{.most_parameters = 0}).converged;
    } catch (const Error&) {  // some values on the way have no derivative
      return false;
    }
  };
  GroupRefits result = refitWithoutGroups(problem, structure, way, fit);
  current.reset();
  return result;
}

Clustered clustered(const Estimator& est) { return clustered(est, ClusterOptions{}); }

Clustered clustered(const Estimator& est, const ClusterOptions& options) {
  EstimatorState& own = stateOf(est);
  const double factor = own.varianceFactor();
  if (!own.isAtMinimum(factor)) {
    throw Error("slom.not-a-minimum",
                "clustered covariances need the values of a converged fit; call optimize() and check "
                "summary.converged",
                "clustered");
  }
  std::optional<GroupRefits> refits;
  if (options.refit) refits = own.refitGroups(options);
  return own.analyze([&](const LinearizedProblem&) {
    auto state = std::make_shared<Clustered::State>(own.current, own.gauge, factor, options);
    state->refits = std::move(refits);
    return Clustered(std::move(state));
  });
}

}  // namespace slom
