// Parts of a summary that the optimisation does not know: sizes, message, tables and warnings.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "analyze/fit_tables.hpp"
#include "analyze/misfit.hpp"
#include "analyze/singular.hpp"
#include "base/words.hpp"
#include "estimator/state.hpp"
#include "problem/stated_noise.hpp"
#include "slom/analyze/losses.hpp"

namespace slom {

namespace {
void append(std::vector<std::string>& warnings, std::vector<std::string> texts) {
  for (std::string& text : texts) warnings.push_back(std::move(text));
}

/// Returns the faults that no other warning reports.
std::vector<std::string> faultsOf(const Diagnosis& diagnosis) {
  std::vector<std::string> texts;
  for (const Finding& finding : diagnosis.findings) {
    if (finding.is_fault && finding.kind != Finding::Kind::unmeasured_variable) texts.push_back(finding.text);
  }
  return texts;
}

/// Returns whether time is left to analyse the fit.
bool hasTime(const Summary& summary, const Options& options) {
  return summary.seconds < options.max_seconds / 2 && !(options.should_stop && options.should_stop());
}

/// Returns the kind for the present measurements; `all` if there are none.
StatedNoise statedNoise(const Problem& problem) {
  if (statesAllNoise(problem)) return StatedNoise::all;
  const bool any = std::any_of(problem.pools().begin(), problem.pools().end(),
                               [](const auto& pool) { return statesNoise(*pool); });
  return any ? StatedNoise::some : StatedNoise::none;
}

/// Message for an unknown whose column of J is not 0, but whose effect is lost in the rounding of the residuals.
constexpr const char* kHidden =
    "; rounding errors of the residuals hide what it changes here: if they are large because the start is far off, start nearer, or use "
    "LevenbergMarquardt";

std::string iterationLimitMessage(const Summary& summary) {
  const double graduation = summary.trace.back().graduation;
  return "iteration limit of " + std::to_string(summary.iterations) + " reached" +
         (graduation > 1 ? " while the losses were still graduated, mu = " + number(graduation, 6) +
                               "; raise max_iterations"
                         : "");
}

std::string lostRankMessage(const Problem& problem, const ProblemStructure& structure,
                            const std::vector<int>& lost) {
  std::vector<std::string> names;
  for (const int unknown : lost) names.push_back(unknownName(problem, structure, unknown));
  return "[slom.rank-deficient] the measurements determine " + listed(names) +
         " at the start, but not where the fit has ended: it is a plateau or a saddle, not a minimum; start from "
         "other values, or add bounds or priors that keep the fit away from there";
}

std::string noProgressMessage(const Evaluator::Promise& promise) {
  return std::string(toString(StopReason::no_progress)) +
         (promise.is_known
              ? ", although the linear model predicts a decrease by " + number(promise.decrease, 3)
              : "") +
         ": derivatives may be wrong (slom::checkDerivatives(est) compares them with differences), residuals may jump, or values and residuals "
         "may be so large that rounding hides small changes";
}
}  // namespace

void Estimator::State::complete(Summary& summary, const Options& options, const RankAtEnd& rank) {
  if (!evaluator.collective().isAlone()) return completeTogether(summary, options, rank);
  fillSizes(summary);
  summary.message = messageFor(summary, options, rank);
  countFreeDirections(summary, options);
  fillTables(summary, options);
  addWarnings(summary, options);
}

void Estimator::State::fillSizes(Summary& summary) {
  fillGroups(problem, run([&] { return linearizer.rssPerPool(problem); }), summary, false);
  const ProblemStructure& structure = evaluator.structure();
  summary.solver = evaluator.solver().description();
  summary.variables = structure.system.filledCount();
  summary.measurements = structure.residuals;
  summary.unknowns = structure.system.unknowns() - problem.activeSet().fixedOrActiveCount();
  summary.redundancy = summary.measurements - summary.unknowns;
  summary.sigma_is_estimated = sigma == Sigma::estimated;
  summary.stated_noise = statedNoise(problem);
}

std::string Estimator::State::noiseOfTests(double variance_factor) const {
  const StatedNoise stated = statedNoise(problem);
  if (sigma == Sigma::estimated)
    return "standard deviations are estimated from the residuals: " +
           (stated == StatedNoise::none ? number(std::sqrt(variance_factor), 4) + " for each residual"
                                        : "those stated, times " + number(std::sqrt(variance_factor), 4));
  return stated == StatedNoise::all
             ? ""
             : std::string("no standard deviation was stated") +
                   (stated == StatedNoise::some ? " for some measurements" : "") +
                   ", 1 is assumed; setSigma(slom::Sigma::estimated) takes it from the residuals";
}

void Estimator::State::countFreeDirections(Summary& summary, const Options& options) {
  if (summary.unknowns == 0 || summary.unknowns > Summary::kMostCounted || evaluator.hadFullRank() ||
      !hasTime(summary, options))
    return;
  try {
    summary.free_directions =
        analyze([](const LinearizedProblem& linearized) { return linearized.freeDirections(); });
    summary.redundancy += summary.free_directions;
  } catch (const Error&) {  // there are no derivatives
  }
}

void Estimator::State::fillTables(Summary& summary, const Options& options) {
  summary.active_bounds = activeBounds(problem);
  if (summary.unknowns > options.most_parameters) summary.parameters_not_shown = summary.unknowns;
  if (summary.unknowns == 0 || summary.unknowns > options.most_parameters ||
      summary.stop_reason == StopReason::rank_deficient)
    return;
  try {
    const double factor = varianceFactor();
    analyze([&](const LinearizedProblem& linearized) { fillParameters(linearized, gauge, factor, summary); });
  } catch (const Error&) {  // there are no covariances
    if (summary.free_directions > 0)
      summary.undetermined =
          analyze([](const LinearizedProblem& linearized) { return faultsOf(linearized.diagnosis()); });
  }
}

void Estimator::State::addWarnings(Summary& summary, const Options& options) {
  if (summary.stop_reason == StopReason::rank_deficient) explainRankDeficiency(summary, options);
  append(summary.warnings, unmeasuredVariables(problem));
  append(summary.warnings, misfits(problem, summary));
  given_derivatives.check(problem, summary.warnings);
}

/// Explains the loss of rank by losses that give whole groups weight 0 or, if there is time, by a diagnosis.
void Estimator::State::explainRankDeficiency(Summary& summary, const Options& options) {
  std::vector<std::string> weightless = weightlessMeasurements(summary.groups);
  const bool is_explained = !weightless.empty();
  append(summary.warnings, std::move(weightless));
  if (!is_explained && hasTime(summary, options))
    append(summary.warnings,
           analyze([](const LinearizedProblem& linearized) { return faultsOf(linearized.diagnosis()); }));
}

std::string Estimator::State::messageFor(const Summary& summary, const Options& options,
                                         const RankAtEnd& rank) {
  switch (summary.stop_reason) {
    case StopReason::rank_deficient:
      if (!rank.lost.empty()) return lostRankMessage(problem, evaluator.structure(), rank.lost);
      return singularError(problem, evaluator.structure(), rank.singular_at).what() +
             std::string(evaluator.wasHidden() ? kHidden : "");
    case StopReason::max_iterations:
      return iterationLimitMessage(summary);
    case StopReason::no_progress:
      return noProgressMessage(run([&] { return evaluator.promise(false); }));
    case StopReason::time_limit:
      return "time limit of " + number(options.max_seconds, 6) + " s reached";
    default:
      return toString(summary.stop_reason);
  }
}

}  // namespace slom
