#include "slom/optimize/optimizer.hpp"

#include <chrono>
#include <cmath>
#include <limits>

namespace slom {

const char* toString(StopReason reason) {
  switch (reason) {
    case StopReason::gradient: return "gradient below tolerance";
    case StopReason::decrease: return "relative decrease below tolerance";
    case StopReason::step: return "step below tolerance";
    case StopReason::nothing_to_do: return "nothing to optimize";
    case StopReason::max_iterations: return "iteration limit reached";
    case StopReason::no_progress: return "no step makes the RSS smaller";
    case StopReason::rank_deficient: return "rank deficient";
    case StopReason::not_finite: return "a residual became not finite";
  }
  return "unknown";
}

bool isConverged(StopReason reason) { return reason <= StopReason::nothing_to_do; }

double Summary::chi2PerDof() const {
  return redundancy > 0 ? final_rss / redundancy : std::numeric_limits<double>::quiet_NaN();
}

namespace {

class Run {
 public:
  Run(System& system, Algorithm& algorithm, const Options& options)
      : system_(system), algorithm_(&algorithm), options_(options) {}

  Summary go(SolveStatus& singular_at) {
    summary_.initial_rss = summary_.final_rss = system_.linearize();
    record({}, system_.gradientCosine());
    summary_.stop_reason = iterate();
    summary_.converged = isConverged(summary_.stop_reason);
    summary_.algorithm = algorithm_->name();
    summary_.seconds = secondsSinceStart();
    singular_at = singular_at_;
    return std::move(summary_);
  }

 private:
  StopReason iterate() {
    if (system_.structure().system.unknowns() == 0 || system_.structure().residuals == 0) {
      return StopReason::nothing_to_do;
    }
    while (summary_.iterations < options_.max_iterations) {
      system_.linearize();
      const double gradient = system_.gradientCosine();
      // A system without full rank is told about even when the RSS could not be smaller; the step finds out.
      StepOutcome outcome = algorithm_->step(system_, options_);
      if (mustFallBack(outcome)) continue;
      ++summary_.iterations;
      summary_.final_rss = outcome.rss_after;
      record(outcome, gradient);
      switch (outcome.kind) {
        case StepOutcome::Kind::singular:
          singular_at_ = outcome.status;
          return StopReason::rank_deficient;
        case StepOutcome::Kind::not_finite:
          return StopReason::not_finite;
        case StepOutcome::Kind::stuck:
          return whyStuck(outcome, gradient);
        case StepOutcome::Kind::taken:
          break;
      }
      if (gradient <= options_.gradient_tolerance) return StopReason::gradient;
      if (hasLittleDecrease(outcome)) return StopReason::decrease;
      if (system_.isNegligible(outcome.step, options_.step_tolerance)) return StopReason::step;
    }
    return StopReason::max_iterations;
  }

  StopReason whyStuck(const StepOutcome& outcome, double gradient) {
    if (gradient <= options_.gradient_tolerance) return StopReason::gradient;
    if (hasLittleDecrease(outcome)) return StopReason::decrease;
    return system_.isNegligible(outcome.step, options_.step_tolerance) ? StopReason::step : StopReason::no_progress;
  }

  bool hasLittleDecrease(const StepOutcome& outcome) const {
    const double little = options_.decrease_tolerance * outcome.rss_before;
    return std::abs(outcome.rss_before - outcome.rss_after) <= little && outcome.predicted_decrease <= little;
  }

  /// A Gauss-Newton step that leads uphill is taken back, and Levenberg-Marquardt goes on from where it started.
  bool mustFallBack(const StepOutcome& outcome) {
    if (!options_.fall_back || dynamic_cast<GaussNewton*>(algorithm_) == nullptr) return false;
    const bool grew = outcome.kind == StepOutcome::Kind::taken && outcome.rss_after > outcome.rss_before &&
                      !hasLittleDecrease(outcome) && !system_.isNegligible(outcome.step, options_.step_tolerance);
    if (!grew && outcome.kind != StepOutcome::Kind::not_finite) return false;
    if (grew) system_.undo();
    algorithm_ = &fallback_;
    summary_.warnings.push_back("iteration " + std::to_string(summary_.iterations + 1) +
                                ": the Gauss-Newton step made " +
                                (grew ? "the RSS grow" : std::string("a residual not finite")) +
                                "; it was taken back and Levenberg-Marquardt went on from there");
    return true;
  }

  void record(const StepOutcome& outcome, double gradient) {
    IterationRecord line;
    line.iteration = summary_.iterations;
    line.algorithm = algorithm_->name();
    line.rss = summary_.final_rss;
    line.gradient = gradient;
    if (outcome.trials > 0) {
      line.relative_decrease = outcome.rss_before > 0 ? (outcome.rss_before - outcome.rss_after) / outcome.rss_before : 0;
      line.step = outcome.kind == StepOutcome::Kind::taken ? system_.stepInDeviations(outcome.step) : 0;
      line.damping = outcome.damping;
      line.trials = outcome.trials;
    } else {
      line.trials = 0;
    }
    line.seconds = secondsSinceStart();
    summary_.trace.push_back(line);
    if (options_.observer) options_.observer(line);
  }

  double secondsSinceStart() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

  System& system_;
  Algorithm* algorithm_;
  LevenbergMarquardt fallback_;
  const Options& options_;
  Summary summary_;
  SolveStatus singular_at_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace

Summary runAlgorithm(System& system, Algorithm& algorithm, const Options& options, SolveStatus& singular_at) {
  return Run(system, algorithm, options).go(singular_at);
}

}  // namespace slom
