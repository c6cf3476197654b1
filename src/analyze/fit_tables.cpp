#include "analyze/fit_tables.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "analyze/residual_tests.hpp"
#include "base/index.hpp"
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

namespace {

/// A sink that writes rotations and directions into the rows of their variable.
class OrientationRows final : public OrientationSink {
 public:
  OrientationRows(std::vector<ParameterSummary>& rows, bool& has_rotations)
      : rows_(rows), has_rotations_(has_rotations) {}
  void take(Kind kind, int component, const double* numbers) override {
    const auto first = static_cast<std::size_t>(component);
    if (kind == Kind::direction) {
      rows_[first].text =
          "(" + number(numbers[0], 4) + " " + number(numbers[1], 4) + " " + number(numbers[2], 4) + ")";
      return;
    }
    const std::size_t count = kind == Kind::angle ? 1 : 3;
    has_rotations_ = has_rotations_ || count == 3;
    for (std::size_t i = 0; i < count; ++i) rows_[first + i].value = numbers[i];
  }

 private:
  std::vector<ParameterSummary>& rows_;
  bool& has_rotations_;
};

/// Shows a user's own manifold, which has neither coordinates nor an orientation. The row of its first component gets
/// the output of its operator<<.
void showOwnManifold(const Problem& problem, int variable, std::vector<ParameterSummary>& rows) {
  constexpr std::size_t most = 40;
  const auto is_blank = [](const ParameterSummary& row) { return row.text.empty() && std::isnan(row.value); };
  if (rows.empty() || !std::ranges::all_of(rows, is_blank)) return;
  const VariableRecord& record = problem.variables()[at(variable)];
  const std::string text = problem.variableValue(variable);
  const bool is_written = text != "a " + record.store->typeName();
  if (is_written && text.size() <= most && text.find('\n') == std::string::npos) rows.front().text = text;
}

/// Returns a row for each component of the variable.
std::vector<ParameterSummary> rowsOf(const Problem& problem, int variable, bool& has_rotations) {
  const VariableRecord& record = problem.variables()[static_cast<std::size_t>(variable)];
  std::vector<ParameterSummary> rows(static_cast<std::size_t>(record.dof));
  const std::vector<std::string> names = problem.componentNames(variable);
  std::vector<double> x(rows.size());
  const void* const value = record.store->valueAt(record.slot);
  record.store->coordinates(value, x.data());
  for (std::size_t c = 0; c < rows.size(); ++c) {
    rows[c].name = names[c];
    rows[c].value = x[c];
  }
  OrientationRows orientations(rows, has_rotations);
  record.store->visitOrientations(value, orientations);
  showOwnManifold(problem, variable, rows);
  return rows;
}

/// Adds the rows of all unknowns. deviation(variable, component, unknown) returns a standard deviation.
template <class Deviation>
void addRows(const LinearizedProblem& linearized, Summary& summary, const Deviation& deviation) {
  const ProblemStructure& structure = linearized.structure();
  for (int v = 0; v < structure.system.blockCount(); ++v) {
    if (structure.system.isEmpty(v)) continue;
    std::vector<ParameterSummary> rows = rowsOf(linearized.problem(), v, summary.has_rotations);
    for (int c = 0; c < static_cast<int>(rows.size()); ++c) {
      if (linearized.activeSet().isFixedOrActive(v, c)) continue;
      ParameterSummary& row = rows[static_cast<std::size_t>(c)];
      row.standard_deviation = deviation(v, c, structure.offsetOf(v) + c);
      summary.parameters.push_back(std::move(row));
    }
  }
}

/// Fills in the strongest correlations of these unknowns.
void fillCorrelations(const Eigen::MatrixXd& C, const std::vector<int>& unknowns, Summary& summary) {
  constexpr double strong = 0.95;
  constexpr std::size_t most = 5;
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
  if (summary.correlations.size() <= most) return;
  summary.correlations_not_shown = static_cast<int>(summary.correlations.size() - most);
  summary.correlations.resize(most);
}

/// Lists what is poorly determined, if columns of J are nearly dependent.
void fillUndetermined(const LinearizedProblem& linearized, double largest_inflation, Summary& summary) {
  constexpr double nearly_dependent = 1e10;
  if (!(largest_inflation > nearly_dependent)) return;
  for (const Finding& finding : linearized.diagnosis().findings) {
    if (finding.kind == Finding::Kind::weak) summary.undetermined.push_back(finding.text);
  }
}

}  // namespace

void fillParameters(const LinearizedProblem& linearized, FreeGauge gauge, double variance_factor,
                    Summary& summary) {
  const Eigen::MatrixXd C =
      variance_factor * linearized.covarianceColumns(gauge, 0, linearized.structure().system.unknowns());
  const std::vector<GroupCheck> checks = checkGroups(linearized, gauge);
  std::vector<int> unknowns;
  addRows(linearized, summary, [&](int, int, int unknown) {
    unknowns.push_back(unknown);
    return std::sqrt(C(unknown, unknown));
  });
  fillCorrelations(C, unknowns, summary);
  fillUndetermined(linearized, C.diagonal().cwiseProduct(linearized.diagonal()).maxCoeff() / variance_factor,
                   summary);
  // If columns of J are nearly dependent, rounding spoils the redundancies of groups. Their sum then differs from the
  // redundancy.
  double sum = 0;
  for (const GroupCheck& check : checks) sum += check.redundancy;
  if (std::abs(sum - summary.redundancy) > 1e-3 * std::max(1, summary.redundancy)) return;
  for (GroupSummary& group : summary.groups) {
    for (const GroupCheck& check : checks) {
      if (check.name == group.name) group.redundancy = check.redundancy;
    }
  }
}

void addParameters(const LinearizedProblem& linearized, FreeGauge gauge, double variance_factor,
                   Summary& summary) {
  if (!summary.parameters.empty()) return;
  const int unknowns = linearized.freeUnknowns();
  if (summary.unknowns != unknowns) {
    throw Error("slom.no-parameters",
                "the summary belongs to a fit of " + counted(summary.unknowns, "unknown") +
                    ", but there are " + std::to_string(unknowns) + " now; take the summary of the last fit",
                "Summary");
  }
  for (UnknownRow& unknown : unknownRows(linearized, gauge, variance_factor, summary.has_rotations)) {
    if (!unknown.is_at_bound) summary.parameters.push_back(std::move(unknown.row));
  }
  summary.parameters_not_shown = 0;
}

std::vector<UnknownRow> unknownRows(const LinearizedProblem& linearized, FreeGauge gauge,
                                    double variance_factor, bool& has_rotations) {
  const ProblemStructure& structure = linearized.structure();
  const InverseBlocks& inverse = linearized.inverse(gauge);
  std::vector<UnknownRow> result;
  for (int v = 0; v < structure.system.blockCount(); ++v) {
    if (structure.system.isEmpty(v)) continue;
    std::vector<ParameterSummary> rows = rowsOf(linearized.problem(), v, has_rotations);
    const int dof = structure.system.dof(v);
    Eigen::MatrixXd C(dof, dof);
    inverse.block(v, v, C.data());
    for (int c = 0; c < dof; ++c) {
      if (linearized.activeSet().isFixed(v, c)) continue;
      UnknownRow& unknown = result.emplace_back(
          UnknownRow{v, c, std::move(rows[at(c)]), linearized.activeSet().isFixedOrActive(v, c)});
      if (!unknown.is_at_bound) unknown.row.standard_deviation = std::sqrt(variance_factor * C(c, c));
    }
  }
  return result;
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
