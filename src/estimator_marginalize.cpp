// Marginalisation: variables and their measurements are replaced by priors on the variables that those measurements share with them.
#include <algorithm>
#include <utility>
#include <vector>

#include "estimator_state.hpp"
#include "linearize/marginal_information.hpp"
#include "slom/measurements/gaussian_prior.hpp"

namespace slom {

namespace {
/// Places in the problem's table, ascending, each once.
std::vector<int> indicesOf(const Problem& problem, const std::vector<AnyVarID>& ids) {
  std::vector<int> variables;
  for (const AnyVarID& id : ids) variables.push_back(problem.indexOf(static_cast<const VariableHandle&>(id)));
  std::sort(variables.begin(), variables.end());
  variables.erase(std::unique(variables.begin(), variables.end()), variables.end());
  return variables;
}

/// A prior for each factor; all of them or, where that throws, none.
std::vector<MeasID<GaussianPrior>> insertPriors(Estimator& estimator, const Problem& problem,
                                                const std::vector<InformationFactor>& factors) {
  std::vector<MeasID<GaussianPrior>> priors;
  priors.reserve(factors.size());
  try {
    for (const InformationFactor& factor : factors) {
      std::vector<AnyVarID> left;
      for (const int v : factor.variables) left.emplace_back(problem.handleOf(v));
      priors.push_back(estimator.insertMeasurement(GaussianPrior(std::move(left), factor.R, factor.b)));
    }
  } catch (...) {  // memory is short
    for (const MeasID<GaussianPrior>& id : priors) estimator.removeMeasurement(id);
    throw;
  }
  return priors;
}

void removeEliminated(Problem& problem, const std::vector<MeasurementIndex>& measurements,
                      const std::vector<int>& variables) {
  // Starts with the last one, as the last one of a pool takes the place of a removed one.
  for (auto m = measurements.rbegin(); m != measurements.rend(); ++m) {
    problem.removeMeasurement(*problem.pools()[static_cast<std::size_t>(m->first)], m->second);
  }
  for (const int v : variables) problem.removeVariable(v);
}
}  // namespace

std::vector<MeasID<GaussianPrior>> Estimator::marginalize(const std::vector<AnyVarID>& ids) {
  Problem& all = problem();
  const std::vector<int> variables = indicesOf(all, ids);
  const std::vector<MeasurementIndex> measurements = measurementsOf(all, variables);
  const std::vector<InformationFactor> factors =
      state_->run([&] { return marginalInformation(all, state_->linearizer, measurements, variables); });
  std::vector<MeasID<GaussianPrior>> priors = insertPriors(*this, all, factors);
  removeEliminated(all, measurements, variables);
  return priors;
}

}  // namespace slom
