// Marginalisation: priors replace variables and their measurements. The priors depend on the variables that those
// measurements share with the rest. Also these priors alone.
#include <algorithm>
#include <utility>
#include <vector>

#include "estimator/state.hpp"
#include "linearize/marginal_information.hpp"
#include "slom/conditional.hpp"
#include "slom/problem/group_table.hpp"

namespace slom {

/// Maker of priors that are linearised at the points where their rows were.
class MarginalPrior {
 public:
  /// Returns the prior for the rows R d + b. The rows are those at the linearisation points x0 of their variables x,
  /// and d = 0 at the current values. As a function of x they are R (x [-] x0) + b', with b' = b - R (x_now [-] x0).
  static GaussianPrior of(const Problem& problem, const InformationFactor& factor) {
    std::vector<AnyVarID> left;
    Eigen::VectorXd moved(factor.R.cols());
    double* next = moved.data();
    for (const int v : factor.variables) {
      left.emplace_back(problem.handleOf(v));
      const VariableRecord& record = problem.variables()[static_cast<std::size_t>(v)];
      record.store->boxminus(next, record.store->valueAt(record.slot), problem.linearizationPoint(v));
      next += record.dof;
    }
    GaussianPrior prior(std::move(left), factor.R, factor.b - factor.R * moved);
    int k = 0;
    for (const int v : factor.variables) prior.setPoint(k++, problem.linearizationPoint(v));
    return prior;
  }
};

namespace {
/// Returns the places in the problem's table, ascending and without duplicates.
std::vector<int> indicesOf(const Problem& problem, const std::vector<AnyVarID>& ids) {
  std::vector<int> variables;
  for (const AnyVarID& id : ids) variables.push_back(problem.indexOf(static_cast<const VariableHandle&>(id)));
  std::sort(variables.begin(), variables.end());
  variables.erase(std::unique(variables.begin(), variables.end()), variables.end());
  return variables;
}

/// Returns the priors that remain of the measurements after the variables are eliminated.
std::vector<GaussianPrior> priorsOf(const Problem& problem, Linearizer& linearizer,
                                    const std::vector<MeasurementIndex>& measurements,
                                    const std::vector<int>& variables) {
  std::vector<GaussianPrior> priors;
  for (const InformationFactor& factor : marginalInformation(problem, linearizer, measurements, variables))
    priors.push_back(MarginalPrior::of(problem, factor));
  return priors;
}

/// Inserts all priors; if that throws, inserts none.
std::vector<MeasID<GaussianPrior>> insertAll(Estimator& estimator, std::vector<GaussianPrior> priors) {
  std::vector<MeasID<GaussianPrior>> ids;
  ids.reserve(priors.size());
  try {
    for (GaussianPrior& prior : priors) ids.push_back(estimator.insertMeasurement(std::move(prior)));
  } catch (...) {  // out of memory
    for (const MeasID<GaussianPrior>& id : ids) estimator.removeMeasurement(id);
    throw;
  }
  return ids;
}

/// Puts the priors into the groups that all of the measurements share.
void keepGroups(Problem& problem, const std::vector<MeasurementIndex>& measurements,
                const std::vector<MeasID<GaussianPrior>>& priors) {
  const int dimensions = problem.groups() == nullptr ? 0 : problem.groups()->dimensionCount();
  for (int d = 0; d < dimensions && !measurements.empty(); ++d) {
    const auto keyOf = [&](const MeasurementIndex& m) {
      return problem.pools()[static_cast<std::size_t>(m.first)]->groupKey(d, m.second);
    };
    const int key = keyOf(measurements.front());
    if (key < 0 || !std::all_of(measurements.begin(), measurements.end(),
                                [&](const MeasurementIndex& m) { return keyOf(m) == key; }))
      continue;
    for (const MeasID<GaussianPrior>& prior : priors) {
      const auto [pool, i] = problem.locate(prior);
      pool->setGroupKey(d, i, key);
    }
  }
}

void removeEliminated(Problem& problem, const std::vector<MeasurementIndex>& measurements,
                      const std::vector<int>& variables) {
  // The loop runs backwards, because the last measurement of a pool takes the place of a removed one.
  for (auto m = measurements.rbegin(); m != measurements.rend(); ++m) {
    problem.removeMeasurement(*problem.pools()[static_cast<std::size_t>(m->first)], m->second);
  }
  for (const int v : variables) problem.removeVariable(v);
}
}  // namespace

std::vector<MeasID<GaussianPrior>> Estimator::marginalize(const std::vector<AnyVarID>& ids,
                                                          const MarginalizeOptions& options) {
  Problem& all = problem();
  const std::vector<int> variables = indicesOf(all, ids);
  const std::vector<MeasurementIndex> measurements = measurementsOf(all, variables);
  std::vector<GaussianPrior> left =
      state_->run([&] { return priorsOf(all, state_->linearizer, measurements, variables); });
  for (GaussianPrior& prior : left) prior.withFirstEstimates(options.first_estimates);
  std::vector<MeasID<GaussianPrior>> priors = insertAll(*this, std::move(left));
  keepGroups(all, measurements, priors);
  removeEliminated(all, measurements, variables);
  return priors;
}

std::vector<GaussianPrior> conditional(const Estimator& est, const std::vector<AnyVarID>& ids) {
  const Problem& all = est.table();
  const std::vector<int> variables = indicesOf(all, ids);
  Linearizer linearizer;
  return priorsOf(all, linearizer, measurementsOf(all, variables), variables);
}

}  // namespace slom
