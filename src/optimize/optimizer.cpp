#include "slom/optimize/optimizer.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "base/words.hpp"
#include "optimize/convergence.hpp"
#include "optimize/graduation.hpp"
#include "optimize/lengths.hpp"
#include "optimize/options.hpp"
#include "problem/value_snapshot.hpp"
#include "slom/optimize/system.hpp"

namespace slom {

namespace {

/// First damping where long steps have failed.
constexpr double kCautiousDamping = 1e3;

class Run {
 public:
  Run(System& system, Algorithm& algorithm, const Options& options, bool sigma_is_estimated)
      : system_(system),
        safeguarded_(options.fall_back ? algorithm.safeguarded() : nullptr),
        algorithm_(safeguarded_ ? safeguarded_.get() : &algorithm),
        options_(options),
        limits_(options),
        convergence_(system, options, sigma_is_estimated) {
    system_.setInterruption([this] { return mustStop(); });
  }
  ~Run() { system_.setInterruption({}); }

  Summary go(SolveStatus& singular_at) {
    summary_.initial_rss = summary_.final_rss = system_.linearize();
    most_iterations_ = limits_.max_iterations =
        iterationLimit(options_, system_.structure().system.unknowns());
    convergence_.begin(summary_.initial_rss);
    record({}, system_.orthogonality());
    summary_.stop_reason = hasNothingToDo()                   ? StopReason::nothing_to_do
                           : options_.graduated_non_convexity ? graduate()
                           : safeguarded_ != nullptr          ? iterateOrRestart()
                                                              : iterate();
    if (summary_.stages > 0 && summary_.final_rss > summary_.initial_rss) warnOfRise();
    summary_.converged = isConverged(summary_.stop_reason);
    summary_.algorithm = algorithm_->name();
    summary_.seconds = secondsSinceStart();
    const PhaseSeconds now = system_.seconds();
    summary_.phases = {now.setup - before_.setup, now.linearize - before_.linearize,
                       now.factorize - before_.factorize, now.solve - before_.solve};
    singular_at = singular_at_;
    return std::move(summary_);
  }

 private:
  bool hasNothingToDo() {
    return system_.structure().system.unknowns() == 0 || system_.structure().residuals == 0;
  }

  /// Why a fit is to end at once, where it is.
  std::optional<StopReason> interruption() {
    if (!must_stop_ && options_.should_stop && options_.should_stop()) must_stop_ = StopReason::interrupted;
    if (!must_stop_ && secondsSinceStart() > options_.max_seconds) must_stop_ = StopReason::time_limit;
    return must_stop_;
  }
  bool mustStop() { return interruption().has_value(); }

  StopReason graduate() {
    Graduation graduation(system_, options_);
    if (!graduation.hasLosses()) {
      summary_.warnings.push_back(
          "graduated_non_convexity has nothing to graduate, as no measurement has a loss; pass one to "
          "insertMeasurement, such as slom::GemanMcClure(3)");
      return iterate();
    }
    for (;;) {
      ++summary_.stages;
      graduation.advance();
      limits_ = graduation.limits(summary_.iterations, most_iterations_);
      if (graduation.isLast()) {
        if (summary_.stages > 1) algorithm_->reset();
        return iterate();
      }
      const StopReason reason = iterate();
      if (!endsTheFit(reason)) continue;
      system_.setLossGraduation(1);
      summary_.final_rss = system_.rss();
      return reason;
    }
  }

  void warnOfRise() {
    summary_.warnings.push_back("graduated non-convexity ended at the RSS " + number(summary_.final_rss, 6) +
                                ", above that of the start, " + number(summary_.initial_rss, 6) +
                                "; if the start was a good one, fit from it without graduated_non_convexity");
  }

  /// Whether a stage that stopped for this reason is the last one, though its losses are still widened.
  bool endsTheFit(StopReason reason) const {
    if (reason == StopReason::max_iterations) return summary_.iterations >= most_iterations_;
    return reason == StopReason::rank_deficient || reason == StopReason::not_finite ||
           reason == StopReason::time_limit || reason == StopReason::interrupted;
  }

  /// A fit whose long first steps ended where it cannot go on begins again with short ones. Where those end
  /// no better, what the first ones found stays.
  StopReason iterateOrRestart() {
    ValueSnapshot start(system_.problem());
    const StopReason reason = iterate();
    const bool has_moved = summary_.trace.back().rss != summary_.initial_rss || summary_.iterations > 1;
    const bool has_failed = reason == StopReason::rank_deficient || reason == StopReason::no_progress ||
                            reason == StopReason::not_finite;
    if (!has_failed || !has_moved) return reason;
    ValueSnapshot end(system_.problem());
    const double rss = summary_.final_rss;
    LevenbergMarquardt cautious(kCautiousDamping);
    Algorithm* const first = std::exchange(algorithm_, &cautious);
    const int failed_at = summary_.iterations;
    start.restore();
    const StopReason second = iterate();
    algorithm_ = first;
    const double second_rss = summary_.final_rss;
    const bool is_better = second_rss < rss;
    const bool is_worse = second_rss > rss + System::kNoise * rss;
    if (isConverged(second) && !is_worse && hasFullRank()) {
      summary_.warnings.push_back(
          "iteration " + std::to_string(failed_at) + ": " + toString(reason) +
          "; the fit began again from the start by short steps of Levenberg-Marquardt");
      return second;
    }
    if (mustStop()) {
      if (!is_better) keep(end, rss);
      return *interruption();
    }
    if (!is_better) {
      keep(end, rss);
      return reason;
    }
    return isConverged(second) ? reason : second;  // better values, but without full rank
  }

  void keep(ValueSnapshot& values, double rss) {
    values.restore();
    summary_.final_rss = rss;
  }

  /// Whether many steps one after the other have changed the RSS by rounding alone, and the promise hardly.
  bool creeps(const StepOutcome& outcome) {
    constexpr int many = 50;
    if (std::abs(outcome.rss_before - outcome.rss_after) > System::kNoise * outcome.rss_before) {
      hidden_steps_ = 0;
      hidden_promise_ = std::numeric_limits<double>::infinity();
    } else if (++hidden_steps_ % many == 0) {
      const double promised = system_.promise().decrease;
      if (!(promised < hidden_promise_ / 2)) return true;
      hidden_promise_ = promised;
    }
    return false;
  }

  bool hasFullRank() {
    Eigen::VectorXd ignored;
    system_.linearize();
    return system_.solveUndamped(ignored).ok;
  }

  /// Steps until there is a reason to stop.
  StopReason iterate() {
    is_fresh_ = false;
    step_limits_ = limits_;
    std::optional<StopReason> reason;
    while (!reason)
      reason = summary_.iterations < limits_.max_iterations ? iterateOnce() : StopReason::max_iterations;
    algorithm_->finish(system_);
    if (!isConverged(*reason)) summary_.final_rss = system_.rss();
    return *reason;
  }

  /// Linearises, solves, tries, accepts or rejects, records. Returns why to stop, if so.
  std::optional<StopReason> iterateOnce() {
    if (const auto stop = interruption()) return stop;
    system_.linearize();
    const double gradient = system_.orthogonality();
    // A system without full rank is reported even when the RSS could not be smaller; the step finds out.
    StepOutcome outcome = algorithm_->step(system_, step_limits_);
    if (outcome.kind == StepOutcome::Kind::stopped) return interruption();
    if (outcome.kind == StepOutcome::Kind::taken)
      requireStepLength(outcome.step.size(), system_.structure().system.unknowns());
    if (outcome.kind == StepOutcome::Kind::taken && !hasDerivatives(outcome))
      outcome.kind = StepOutcome::Kind::not_finite;
    ++summary_.iterations;
    summary_.final_rss = outcome.rss_after;
    if (!outcome.event.empty())
      summary_.warnings.push_back("iteration " + std::to_string(summary_.iterations) + ": " + outcome.event);
    record(outcome, gradient);
    switch (outcome.kind) {
      case StepOutcome::Kind::taken:
        return afterStep(outcome, gradient);
      case StepOutcome::Kind::singular:
        singular_at_ = outcome.status;
        return StopReason::rank_deficient;
      case StepOutcome::Kind::not_finite:
        return StopReason::not_finite;
      default:
        return whenStuck(outcome, gradient);
    }
  }

  /// Where derivatives at the end of a step are not finite, as those of sqrt(limit - x) at its bound, goes a part of it. Returns whether
  /// there are derivatives now; if not, the values are those before the step.
  bool hasDerivatives(StepOutcome& outcome) {
    constexpr double part = 0.9, smaller = 0.5;  // of the way to a bound, at first and from there on
    constexpr int most = 20;
    const auto isLinearized = [&] {
      try {
        system_.linearize();
        return true;
      } catch (const Error& error) {
        if (error.id() != "slom.not-finite") throw;
        return false;
      }
    };
    if (!system_.problem().activeSet().hasBounds() || isLinearized()) return true;
    system_.undo();
    outcome.step = part * system_.withinBounds(outcome.step);
    outcome.is_undamped = false;
    for (int i = 0; i < most; ++i, outcome.step *= smaller) {
      outcome.rss_after = system_.tryStep(outcome.step);
      if (outcome.rss_after < outcome.rss_before && isLinearized()) return true;
      system_.undo();
    }
    outcome.rss_after = outcome.rss_before;
    return false;
  }

  std::optional<StopReason> afterStep(const StepOutcome& outcome, double gradient) {
    is_fresh_ = false;
    if (const auto reason = convergence_.afterStep(outcome, gradient, limits_.decrease_tolerance))
      return reason;
    if (!creeps(outcome)) return std::nullopt;
    const auto reason = convergence_.whenStuck(system_.orthogonality(), limits_.decrease_tolerance);
    if (reason || !convergence_.hasAdvanced()) return reason.value_or(StopReason::no_progress);
    summary_.final_rss = system_.linearize();
    return std::nullopt;
  }

  std::optional<StopReason> whenStuck(const StepOutcome& outcome, double gradient) {
    const auto reason = convergence_.whenStuck(gradient, limits_.decrease_tolerance, outcome.status.ok);
    if (reason) return reason;
    if (!outcome.status.ok) {
      singular_at_ = outcome.status;
      return StopReason::rank_deficient;
    }
    if (convergence_.hasAdvanced()) {
      summary_.final_rss = system_.linearize();
      record({}, gradient);
      return std::nullopt;
    }
    // What earlier steps taught may be what holds it, or that the algorithm took small promises for none.
    if (is_fresh_) return convergence_.isHidden() ? StopReason::decrease : StopReason::no_progress;
    algorithm_->reset();
    step_limits_.decrease_tolerance = step_limits_.deviation_tolerance = 0;
    is_fresh_ = true;
    return std::nullopt;
  }

  void record(const StepOutcome& outcome, double gradient) {
    IterationRecord line;
    line.iteration = summary_.iterations;
    line.algorithm = algorithm_->name();
    line.rss = summary_.final_rss;
    line.gradient = gradient;
    if (outcome.trials > 0) {
      line.relative_decrease =
          outcome.rss_before > 0 ? (outcome.rss_before - outcome.rss_after) / outcome.rss_before : 0;
      line.step = outcome.kind == StepOutcome::Kind::taken ? system_.stepInDeviations(outcome.step) : 0;
      line.damping = outcome.damping;
      line.trials = outcome.trials;
    } else {
      line.trials = 0;
    }
    line.graduation = system_.lossGraduation();
    line.seconds = secondsSinceStart();
    summary_.trace.push_back(line);
    if (options_.observer && options_.observer(line) == FitControl::stop && !must_stop_)
      must_stop_ = StopReason::interrupted;
  }

  double secondsSinceStart() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

  System& system_;
  std::unique_ptr<Algorithm> safeguarded_;
  Algorithm* algorithm_;
  const Options& options_;
  Options limits_;         // of the stage
  Options step_limits_;    // those that the algorithm's steps get
  bool is_fresh_ = false;  // no step was taken since the algorithm was reset where it was stuck
  Convergence convergence_;
  int most_iterations_ = 0, hidden_steps_ = 0;
  double hidden_promise_ = std::numeric_limits<double>::infinity();
  std::optional<StopReason> must_stop_;
  Summary summary_;
  SolveStatus singular_at_;
  PhaseSeconds before_ = system_.seconds();
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace

Summary runAlgorithm(System& system, Algorithm& algorithm, const Options& options, bool sigma_is_estimated,
                     SolveStatus& singular_at) {
  requireValid(options);
  return Run(system, algorithm, options, sigma_is_estimated).go(singular_at);
}

}  // namespace slom
