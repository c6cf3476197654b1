#include "analyze/preflight.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ostream>

#include "analyze/diagnose.hpp"
#include "analyze/singular.hpp"
#include "base/classic_numbers.hpp"
#include "base/index.hpp"
#include "base/words.hpp"

namespace slom {

namespace {

constexpr int kDerivativesOfGroup = 50;    // number of measurements with compared derivatives
constexpr std::size_t kMostVariables = 3;  // number of variables named for having too few residuals

class Inspection {
 public:
  explicit Inspection(const LinearizedProblem& linearized)
      : linearized_(linearized), problem_(linearized.problem()) {}

  Preflight run() {
    std::vector<PreflightGroup> groups(at(problem_.groupCount()));
    for (const auto& pool : problem_.pools()) evaluate(*pool, groups[at(pool->group())]);
    for (PreflightGroup& group : groups) {
      if (group.measurements > 0) result_.groups.push_back(std::move(group));
    }
    for (std::string& text : unmeasuredVariables(problem_)) result_.faults.push_back(std::move(text));
    const bool can_differentiate = result_.faults.empty();
    countResiduals();
    if (can_differentiate) {
      checkDerivatives();
      for (const Finding& finding : linearized_.diagnosis().findings) {
        (finding.is_fault ? result_.faults : result_.warnings).push_back(finding.text);
      }
    }
    return std::move(result_);
  }

 private:
  void evaluate(MeasurementPool& pool, PreflightGroup& group) {
    group.name = pool.name();
    group.measurements += pool.size();
    int bad = 0;
    std::string first;
    std::vector<double> r;
    for (int i = 0; i < pool.size(); ++i) {
      group.residuals += pool.rows(i);
      r.resize(at(pool.rows(i)));
      std::string fault;
      try {
        if (pool.evaluate(i, i + 1, r.data()) >= 0) fault = "is not finite";
      } catch (const MeasurementThrew&) {
        fault = "cannot be evaluated, because its function throws";
      }
      if (!fault.empty()) {
        if (bad++ == 0) {
          first = pool.measurementName(i) + " " + fault + " at " +
                  problem_.valuesText(pool.variables(i), pool.arity());
        }
        continue;
      }
      double squared = 0;
      for (const double x : r) squared += x * x;
      group.rss += squared;
      if (std::sqrt(squared) > group.worst_residual || group.worst.empty()) {
        group.worst_residual = std::sqrt(squared);
        group.worst = pool.measurementName(i);
      }
    }
    if (bad > 0) {
      result_.faults.push_back(
          "the residual of " + first +
          (bad > 1 ? "; so are those of " + std::to_string(bad - 1) + " more of the group" : "") +
          "; check data, start values, and where the function divides, takes roots or logarithms");
    }
  }

  void checkDerivatives() {
    result_.derivatives = compareDerivatives(problem_, kDerivativesOfGroup);
    for (const GroupDerivativeCheck& group : result_.derivatives.groups) {
      if (group.error <= DerivativeCheck::kTolerance) continue;
      result_.faults.push_back(group.sentence());
    }
  }

  /// Reports fewer residuals than unknowns, in all or around a variable.
  void countResiduals() {
    const ProblemStructure& structure = linearized_.structure();
    const int unknowns = structure.system.unknowns() - problem_.activeSet().fixedOrActiveCount();
    if (structure.residuals < unknowns) {
      result_.faults.push_back("there are " + counted(structure.residuals, "residual") + " for " +
                               counted(unknowns, "unknown") +
                               ": add measurements or priors, or fix variables");
    }
    std::vector<int> residuals_of(problem_.variables().size(), 0);
    for (const auto& pool : problem_.pools()) {
      for (int i = 0; i < pool->size(); ++i) {
        std::vector<int> variables(pool->variables(i), pool->variables(i) + pool->arity());
        std::sort(variables.begin(), variables.end());
        variables.erase(std::unique(variables.begin(), variables.end()), variables.end());
        for (const int v : variables) residuals_of[at(v)] += pool->rows(i);
      }
    }
    std::vector<std::string> lacking;
    for (int v = 0; v < structure.system.blockCount(); ++v) {
      if (structure.system.isEmpty(v)) continue;
      const VariableRecord& record = problem_.variables()[at(v)];
      int free = 0;
      for (int c = 0; c < record.dof; ++c) free += problem_.activeSet().isFixedOrActive(v, c) ? 0 : 1;
      if (record.uses > 0 && residuals_of[at(v)] < free) {
        lacking.push_back(problem_.variableName(v) + " (" + std::to_string(residuals_of[at(v)]) + " for " +
                          std::to_string(free) + ")");
      }
    }
    if (!lacking.empty()) {
      result_.faults.push_back("fewer residuals than unknowns depend on " +
                               listed(lacking, kMostVariables + 1) +
                               ": add measurements or a prior, or fix what they lack");
    }
  }

  const LinearizedProblem& linearized_;
  const Problem& problem_;
  Preflight result_;
};

}  // namespace

Preflight preflight(const LinearizedProblem& linearized) { return Inspection(linearized).run(); }

std::string Preflight::text() const {
  std::string all =
      faults.empty() ? "ready to be solved\n"
                     : "not ready to be solved: " + counted(static_cast<int>(faults.size()), "fault") + "\n";
  for (const std::string& fault : faults) all += "  fault: " + fault + "\n";
  for (const std::string& warning : warnings) all += "  hint: " + warning + "\n";
  const ClassicNumbers points;
  char line[240];
  for (const PreflightGroup& group : groups) {
    std::snprintf(line, sizeof line, "  %s: %s, RSS %.6g; the worst is %s with %.3g standard deviations\n",
                  group.name.c_str(), counted(group.measurements, "measurement").c_str(), group.rss,
                  group.worst.c_str(), group.worst_residual);
    all += line;
  }
  return all;
}

std::ostream& operator<<(std::ostream& os, const Preflight& preflight) { return os << preflight.text(); }

}  // namespace slom
