#include "analyze/fit_tables.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "analyze/residual_tests.hpp"
#include "base/words.hpp"
#include "slom/analyze/losses.hpp"

namespace slom {

void fillGroups(const Problem& problem, const std::vector<double>& rss, Summary& summary, bool before) {
  summary.groups.resize(static_cast<std::size_t>(problem.groupCount()));
  for (std::size_t p = 0; p < problem.pools().size(); ++p) {
    MeasurementPool& pool = *problem.pools()[p];
    GroupSummary& group = summary.groups[static_cast<std::size_t>(pool.group())];
    if (!before) {
      group.final_rss += rss[p];
      addLosses(problem.naming(pool, [&] { return summarizeLosses(pool); }), group.losses);
      continue;
    }
    group.name = pool.name();
    group.measurements += pool.size();
    for (int i = 0; i < pool.size(); ++i) group.residuals += pool.rows(i);
    group.initial_rss += rss[p];
    group.derivatives = toString(pool.derivatives());
  }
}

void fillParameters(const LinearizedProblem& linearized, FreeGauge gauge, double variance_factor,
                    Summary& summary) {
  constexpr double strong = 0.95;
  constexpr std::size_t most = 5;
  const Problem& problem = linearized.problem();
  const ProblemStructure& structure = linearized.structure();
  const Eigen::MatrixXd C =
      variance_factor * linearized.covarianceColumns(gauge, 0, structure.system.unknowns());
  const OutlierReport checks = checkResiduals(linearized, OutlierOptions{.worst = 0}, 1, gauge);
  std::vector<int> unknowns;
  for (int v = 0; v < structure.system.blockCount(); ++v) {
    if (structure.system.isEmpty(v)) continue;
    const VariableRecord& record = problem.variables()[static_cast<std::size_t>(v)];
    const std::vector<std::string> names = problem.componentNames(v);
    std::vector<double> x(static_cast<std::size_t>(record.dof));
    record.store->coordinates(record.store->valueAt(record.slot), x.data());
    for (int c = 0; c < record.dof; ++c) {
      if (linearized.activeSet().isFixedOrActive(v, c)) continue;
      const int unknown = structure.offsetOf(v) + c;
      unknowns.push_back(unknown);
      summary.parameters.push_back({names[static_cast<std::size_t>(c)], x[static_cast<std::size_t>(c)],
                                    std::sqrt(C(unknown, unknown))});
    }
  }
  for (std::size_t j = 0; j < unknowns.size(); ++j) {
    for (std::size_t i = 0; i < j; ++i) {
      const auto& [a, b] = std::tie(summary.parameters[i], summary.parameters[j]);
      const double correlation = C(unknowns[i], unknowns[j]) / (a.standard_deviation * b.standard_deviation);
      if (std::abs(correlation) >= strong) summary.correlations.push_back({a.name, b.name, correlation});
    }
  }
  std::stable_sort(
      summary.correlations.begin(), summary.correlations.end(),
      [](const auto& a, const auto& b) { return std::abs(a.correlation) > std::abs(b.correlation); });
  if (summary.correlations.size() > most) summary.correlations.resize(most);
  // Where columns of J are nearly dependent, rounding spoils them; then their sum is not the redundancy.
  double sum = 0;
  for (const GroupCheck& check : checks.groups) sum += check.redundancy;
  if (std::abs(sum - summary.redundancy) > 1e-3 * std::max(1, summary.redundancy)) return;
  for (GroupSummary& group : summary.groups) {
    for (const GroupCheck& check : checks.groups) {
      if (check.name == group.name) group.redundancy = check.redundancy;
    }
  }
}

std::vector<std::string> activeBounds(const Problem& problem) {
  std::vector<std::string> result;
  for (const int v : problem.activeSet().constrained()) {
    const VariableRecord& record = problem.variables()[static_cast<std::size_t>(v)];
    std::vector<double> x(static_cast<std::size_t>(record.dof));
    record.store->coordinates(record.store->valueAt(record.slot), x.data());
    for (const ComponentBound& bound : problem.activeSet().bounds(v)) {
      if (!bound.is_active || !problem.activeSet().isOptimized(v)) continue;
      const double value = x[static_cast<std::size_t>(bound.component)];
      const bool is_upper = std::abs(value - bound.upper) < std::abs(value - bound.lower);
      result.push_back(problem.componentNames(v)[static_cast<std::size_t>(bound.component)] + " is at its " +
                       (is_upper ? "upper" : "lower") + " bound " +
                       number(is_upper ? bound.upper : bound.lower, 6));
    }
  }
  return result;
}

}  // namespace slom
