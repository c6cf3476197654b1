// Clustered covariances in other reports: tests of groups, and a column of the summary's table.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ostream>

#include "analyze/clustered/clustered_state.hpp"
#include "base/classic_numbers.hpp"
#include "base/index.hpp"
#include "base/words.hpp"
#include "slom/analyze/chi_square.hpp"
#include "slom/analyze/clustered.hpp"
#include "slom/analyze/student.hpp"
#include "slom/optimize/summary.hpp"

namespace slom {

namespace {

/// Efficiency of the median of absolute deviations: degrees of freedom, for each group, of a scale that is a median.
///   source   Huber and Ronchetti, "Robust statistics", 2009, section 5.1
constexpr double kMedianEfficiency = 0.37;
constexpr double kSignTest = 1.645;  // in standard deviations of the number of signs: 5 %

/// Returns the statistic over the median of its chi-square distribution.
double ratioOf(const ClusterCheck& check) { return check.statistic / chiSquareCritical(0.5, check.dof); }

struct TypicalGroup {
  double ratio = 1;
  int groups = 0, above = 0;  // number with a statistic, and number with one above its median
};

TypicalGroup typicalGroup(const std::vector<ClusterCheck>& checks) {
  std::vector<double> ratios;
  TypicalGroup result;
  for (const ClusterCheck& check : checks) {
    if (check.dof == 0) continue;
    ratios.push_back(ratioOf(check));
    result.above += ratios.back() > 1 ? 1 : 0;
  }
  result.groups = static_cast<int>(ratios.size());
  if (ratios.empty()) return result;
  const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
  std::nth_element(ratios.begin(), middle, ratios.end());
  result.ratio = *middle;
  return result;
}

/// Returns the p-value of the statistic among groups with the scale of their median. Groups may all differ in one
/// direction only. So each statistic counts as the square of one normal number, with a scale known from a median.
double probabilityAmong(const TypicalGroup& typical, const ClusterCheck& check) {
  const double square = ratioOf(check) / typical.ratio * chiSquareCritical(0.5, 1);
  return studentProbability(std::sqrt(square), std::max(1.0, kMedianEfficiency * typical.groups));
}

}  // namespace

ClusterOutliers Clustered::outliers(double significance) const {
  if (!(significance > 0 && significance < 1)) {
    throw Error("slom.bad-option",
                "the significance of tests of groups is " + number(significance, 6) +
                    "; pass a probability between 0 and 1, such as 0.01",
                "significance");
  }
  const std::vector<ClusterCheck> checks = check();
  const TypicalGroup typical = typicalGroup(checks);
  const double half = 0.5 * typical.groups;
  ClusterOutliers result{
      significance, typical.ratio, typical.above > half + kSignTest * std::sqrt(half / 2), {}};
  for (const ClusterCheck& check : checks) {
    ClusterOutliers::Group group{check, 1, false};
    if (check.dof > 0)
      group.probability = result.is_relative ? probabilityAmong(typical, check) : check.probability;
    group.is_suspect = group.probability < significance / static_cast<double>(checks.size());
    result.groups.push_back(std::move(group));
  }
  std::stable_sort(result.groups.begin(), result.groups.end(),
                   [](const auto& a, const auto& b) { return a.probability < b.probability; });
  return result;
}

int ClusterOutliers::suspects() const {
  return static_cast<int>(
      std::count_if(groups.begin(), groups.end(), [](const Group& group) { return group.is_suspect; }));
}

std::string ClusterOutliers::text(int most_groups) const {
  const ClassicNumbers points;
  char line[200];
  std::snprintf(line, sizeof line,
                "%s, %s; half of them pull at the values at least %.3g times as much as stated uncertainties "
                "predict%s\n",
                counted(static_cast<int>(groups.size()), "group").c_str(),
                counted(suspects(), "suspect").c_str(), std::sqrt(scale),
                is_relative ? ": each is compared with the others" : "");
  std::string all = line;
  std::snprintf(line, sizeof line, "  %-24s %12s %10s %5s %11s %14s\n", "group", "measurements", "statistic",
                "dof", "as stated", "probability");
  all += line;
  const std::size_t count = std::min(groups.size(), at(std::max(0, most_groups)));
  for (std::size_t g = 0; g < count; ++g) {
    const ClusterCheck& check = groups[g].check;
    std::snprintf(line, sizeof line, "  %-24s %12d %10.4g %5d %11.2g %14.2g%s\n", check.group.c_str(),
                  check.measurements, check.statistic, check.dof, check.probability, groups[g].probability,
                  groups[g].is_suspect ? "  suspect" : "");
    all += line;
  }
  return all;
}

std::ostream& operator<<(std::ostream& os, const ClusterOutliers& outliers) { return os << outliers.text(); }

void Clustered::addTo(Summary& summary) const {
  const LinearizedProblem& linearized = state_->problem();
  const Problem& all = linearized.problem();
  std::vector<ParameterSummary> filled = summary.parameters;
  std::vector<int> variables;
  std::size_t next = 0;
  bool is_other = filled.empty();
  for (int v = 0; v < linearized.structure().system.blockCount() && !is_other; ++v) {
    if (linearized.structure().system.isEmpty(v)) continue;
    const std::vector<std::string> names = all.componentNames(v);
    std::vector<double> dof(names.size());
    const Eigen::MatrixXd C = state_->covariance({v}).C;
    writePerComponent(v, Kind::dof, 0, dof.data());
    variables.push_back(v);
    for (std::size_t c = 0; c < names.size() && !is_other; ++c) {
      const auto i = static_cast<Eigen::Index>(c);
      if (linearized.activeSet().isFixedOrActive(v, static_cast<int>(c))) continue;
      is_other = next == filled.size() || filled[next].name != names[c];
      if (is_other) continue;
      filled[next].clustered = std::sqrt(C(i, i));
      filled[next++].clustered_dof = dof[c];
    }
  }
  if (is_other || next != filled.size()) {
    throw Error("slom.no-parameters",
                "the summary has no table of the parameters of these covariances; take the summary "
                "of the last fit, with Options::most_parameters not below the number of unknowns",
                "Summary");
  }
  summary.parameters = std::move(filled);
  summary.clustered_notes = notesOn(variables);
}

}  // namespace slom
