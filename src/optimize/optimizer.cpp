#include "slom/optimize/optimizer.hpp"

#include <memory>
#include <optional>
#include <utility>

#include "base/words.hpp"
#include "optimize/convergence.hpp"
#include "optimize/finite_derivatives.hpp"
#include "optimize/graduation.hpp"
#include "optimize/interruption.hpp"
#include "optimize/lengths.hpp"
#include "optimize/lost_rank.hpp"
#include "optimize/options.hpp"
#include "optimize/restart.hpp"
#include "problem/value_snapshot.hpp"
#include "slom/optimize/evaluator.hpp"

namespace slom {

namespace {

/// One fit: iterations until there is a reason to stop. Around them, a second attempt or the stages of graduated
/// non-convexity.
class Run {
 public:
  Run(Evaluator& evaluator, Algorithm& algorithm, const Options& options, bool sigma_is_estimated,
      const std::function<FreeDirections()>& find_free)
      : evaluator_(evaluator),
        safeguarded_(options.fall_back ? algorithm.safeguarded() : nullptr),
        algorithm_(safeguarded_ ? safeguarded_.get() : &algorithm),
        options_(options),
        limits_(options),
        convergence_(evaluator, options, sigma_is_estimated),
        interruption_(options, evaluator.collective()),
        lost_rank_(evaluator, find_free) {
    evaluator_.setInterruption([this] { return interruption_.reason().has_value(); });
  }
  ~Run() { evaluator_.setInterruption({}); }

  Summary go(RankAtEnd& rank) {
    summary_.initial_rss = summary_.final_rss = evaluator_.linearize();
    const int unknowns = evaluator_.unknowns();
    most_iterations_ = limits_.max_iterations = iterationLimit(options_, unknowns);
    convergence_.begin(summary_.initial_rss);
    record({}, evaluator_.orthogonality());
    summary_.stop_reason = unknowns == 0                      ? StopReason::nothing_to_do
                           : evaluator_.residuals() == 0      ? undetermined()
                           : options_.graduated_non_convexity ? graduate()
                           : safeguarded_ != nullptr          ? iterateOrRestart()
                                                              : iterateToRank();
    if (summary_.stages > 0 && summary_.final_rss > summary_.initial_rss) warnOfRise();
    summary_.converged = isConverged(summary_.stop_reason);
    summary_.algorithm = algorithm_->name();
    summary_.seconds = interruption_.seconds();
    const PhaseSeconds now = evaluator_.seconds();
    summary_.phases = {now.setup - before_.setup, now.linearize - before_.linearize,
                       now.factorize - before_.factorize, now.solve - before_.solve};
    rank.singular_at = singular_at_;
    if (has_lost_rank_ && summary_.stop_reason == StopReason::rank_deficient && lost_rank_.examine())
      rank.lost = lost_rank_.unknowns();
    return std::move(summary_);
  }

 private:
  /// Returns the reason to stop if there are unknowns and no measurements.
  StopReason undetermined() {
    singular_at_.unknown = 0;
    return StopReason::rank_deficient;
  }

  // ---- the loop

  /// Iterates until there is a reason to stop.
  StopReason iterate() {
    is_fresh_ = false;
    step_limits_ = limits_;
    std::optional<StopReason> reason;
    try {
      while (!reason)
        reason = summary_.iterations < limits_.max_iterations ? iterateOnce() : StopReason::max_iterations;
    } catch (...) {  // the best values reached so far stay
      algorithm_->finish(evaluator_);
      goBackToBest();
      throw;
    }
    algorithm_->finish(evaluator_);
    if (!isConverged(*reason)) {
      summary_.final_rss = evaluator_.rss();
      if (*reason != StopReason::rank_deficient) goBackToBest();
    }
    best_.reset();
    return *reason;
  }

  /// Iterates. If the iterations end at a saddle or on a plateau, leaves it by a step along a direction that has become
  /// free, if such a step leads downhill, and continues.
  StopReason iterateToRank() {
    constexpr int most_escapes = 20;
    StopReason reason = iterate();
    for (int escapes = 0; lost_rank_.isInDoubt(reason) && lost_rank_.examine(); ++escapes) {
      if (escapes == most_escapes || !lost_rank_.escape()) {
        if (isConverged(reason) && lost_rank_.isMinimum()) return reason;
        has_lost_rank_ = true;
        return StopReason::rank_deficient;
      }
      summary_.final_rss = evaluator_.linearize();
      algorithm_->reset();
      reason = iterate();
    }
    return reason;
  }

  /// Keeps the current values if they are the best so far and the algorithm may leave them for worse ones.
  void keepBest(double rss) {
    if (!algorithm_->mayGoUphill() || evaluator_.lossGraduation() != 1 || (best_ && rss >= best_rss_)) return;
    best_.emplace(evaluator_.problem());
    best_rss_ = rss;
  }
  void goBackToBest() {
    if (!best_ || summary_.final_rss <= best_rss_) return;
    best_->restore();
    summary_.final_rss = evaluator_.rss();
  }

  /// Performs an iteration: linearises; lets the algorithm solve, try the step and accept or reject it; records.
  /// Returns the reason to stop, if any.
  std::optional<StopReason> iterateOnce() {
    if (const auto stop = interruption_.reason()) return stop;
    keepBest(evaluator_.linearize());
    const double gradient = evaluator_.orthogonality();
    // A system without full rank is reported even if the RSS cannot be smaller. The step detects it.
    StepOutcome outcome = algorithm_->step(evaluator_, step_limits_);
    if (outcome.kind == StepOutcome::Kind::stopped) return interruption_.reason();
    if (outcome.kind == StepOutcome::Kind::taken)
      requireStepLength(outcome.step.size(), evaluator_.structure().system.unknowns());
    shortenToFiniteDerivatives(evaluator_, outcome);
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

  /// Handles an accepted step.
  std::optional<StopReason> afterStep(const StepOutcome& outcome, double gradient) {
    is_fresh_ = false;
    if (const auto reason = convergence_.afterStep(outcome, gradient, limits_.decrease_tolerance))
      return reason;
    if (!convergence_.creeps(outcome)) return std::nullopt;
    const auto reason = convergence_.whenStuck(evaluator_.orthogonality(), limits_.decrease_tolerance);
    if (reason || !convergence_.hasAdvanced()) return reason.value_or(StopReason::no_progress);
    summary_.final_rss = evaluator_.linearize();
    return std::nullopt;
  }

  /// Handles an iteration in which all tried steps were rejected.
  std::optional<StopReason> whenStuck(const StepOutcome& outcome, double gradient) {
    const auto reason = convergence_.whenStuck(gradient, limits_.decrease_tolerance, outcome.status.ok);
    if (reason) return reason;
    if (!outcome.status.ok) {
      singular_at_ = outcome.status;
      return StopReason::rank_deficient;
    }
    if (convergence_.hasAdvanced()) {
      summary_.final_rss = evaluator_.linearize();
      record({}, gradient);
      return std::nullopt;
    }
    // The algorithm's state from earlier steps may block it, or it may have taken a small predicted decrease for 0.
    if (is_fresh_) return convergence_.isHidden() ? StopReason::decrease : StopReason::no_progress;
    algorithm_->reset();
    step_limits_.decrease_tolerance = step_limits_.deviation_tolerance = 0;
    is_fresh_ = true;
    return std::nullopt;
  }

  /// Records one line of the trace for the observer.
  void record(const StepOutcome& outcome, double gradient) {
    IterationRecord line;
    line.iteration = summary_.iterations;
    line.algorithm = algorithm_->name();
    line.rss = summary_.final_rss;
    line.gradient = gradient;
    if (outcome.trials > 0) {
      line.relative_decrease =
          outcome.rss_before > 0 ? (outcome.rss_before - outcome.rss_after) / outcome.rss_before : 0;
      line.step = outcome.kind == StepOutcome::Kind::taken ? evaluator_.stepInDeviations(outcome.step) : 0;
      line.damping = outcome.damping;
      line.trials = outcome.trials;
    } else {
      line.trials = 0;
    }
    line.graduation = evaluator_.lossGraduation();
    line.seconds = interruption_.seconds();
    summary_.trace.push_back(line);
    evaluator_.collective().agree([&] {
      if (options_.observer && options_.observer(line) == FitControl::stop) interruption_.request();
    });
  }

  // ---- a second attempt

  /// Iterates. If that fails after long first steps, iterates again from the start with short steps. If those end no
  /// better, keeps the result of the first.
  StopReason iterateOrRestart() {
    Restart restart(evaluator_);
    const StopReason first = iterateToRank();
    if (!Restart::isCalledFor(first, summary_)) return first;
    restart.begin(first, summary_);
    Algorithm* const own = std::exchange(algorithm_, &restart.algorithm());
    const StopReason second = iterateFrom(restart);
    algorithm_ = own;
    if (restart.hasSucceeded(second, summary_.final_rss)) {
      summary_.warnings.push_back(restart.warning());
      return second;
    }
    const auto stop = interruption_.reason();
    const StopReason reason = restart.settle(second, summary_.final_rss);
    return stop.value_or(reason);
  }

  StopReason iterateFrom(Restart& restart) {
    try {
      return iterateToRank();
    } catch (...) {
      restart.settle(StopReason::not_finite, summary_.final_rss);
      throw;
    }
  }

  // ---- stages of graduated non-convexity

  StopReason graduate() {
    Graduation graduation(evaluator_, options_);
    if (!graduation.hasLosses()) {
      summary_.warnings.push_back(
          "graduated_non_convexity has nothing to graduate, because no measurement has a loss; pass a loss "
          "to insertMeasurement, such as slom::GemanMcClure(3)");
      return iterateToRank();
    }
    for (;;) {
      ++summary_.stages;
      graduation.advance();
      limits_ = graduation.limits(summary_.iterations, most_iterations_);
      if (graduation.isLast()) {
        if (summary_.stages > 1) algorithm_->reset();
        return iterateToRank();
      }
      const StopReason reason = iterate();
      if (!endsTheFit(reason)) continue;
      evaluator_.setLossGraduation(1);
      summary_.final_rss = evaluator_.rss();
      return reason;
    }
  }

  /// Returns whether a stage that stopped for this reason is the last one although the graduation parameter of its
  /// losses is above 1.
  bool endsTheFit(StopReason reason) const {
    if (reason == StopReason::max_iterations) return summary_.iterations >= most_iterations_;
    return reason == StopReason::rank_deficient || reason == StopReason::not_finite ||
           reason == StopReason::time_limit || reason == StopReason::interrupted;
  }

  void warnOfRise() {
    summary_.warnings.push_back("graduated non-convexity ended at the RSS " + number(summary_.final_rss, 6) +
                                ", above the RSS of the start, " + number(summary_.initial_rss, 6) +
                                "; if the start was good, fit from it without graduated_non_convexity");
  }

  Evaluator& evaluator_;
  std::unique_ptr<Algorithm> safeguarded_;
  Algorithm* algorithm_;
  const Options& options_;
  Options limits_;         // limits of the stage
  Options step_limits_;    // limits for the algorithm's steps
  bool is_fresh_ = false;  // no step was taken since the stuck algorithm was reset
  Convergence convergence_;
  Interruption interruption_;
  LostRank lost_rank_;
  bool has_lost_rank_ = false;
  std::optional<ValueSnapshot> best_;  // for an algorithm that may go uphill
  double best_rss_ = 0;
  int most_iterations_ = 0;
  Summary summary_;
  SolveStatus singular_at_;
  PhaseSeconds before_ = evaluator_.seconds();
};

}  // namespace

Summary runAlgorithm(Evaluator& evaluator, Algorithm& algorithm, const Options& options,
                     bool sigma_is_estimated, RankAtEnd& rank,
                     const std::function<FreeDirections()>& find_free) {
  requireValid(options);
  return Run(evaluator, algorithm, options, sigma_is_estimated, find_free).go(rank);
}

}  // namespace slom
