#include "slom/optimize/optimizer.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>

#include "slom/optimize/system.hpp"

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

Summary::Summary() = default;
Summary::~Summary() = default;
Summary::Summary(const Summary&) = default;
Summary::Summary(Summary&&) noexcept = default;
Summary& Summary::operator=(const Summary&) = default;
Summary& Summary::operator=(Summary&&) noexcept = default;

double Summary::chi2PerDof() const {
  return redundancy > 0 ? final_rss / redundancy : std::numeric_limits<double>::quiet_NaN();
}

bool Summary::hasLosses() const {
  return std::any_of(groups.begin(), groups.end(), [](const GroupSummary& group) { return !group.losses.empty(); });
}

namespace {

/// A stage of graduated non-convexity is over when the RSS falls by less than this, relatively.
constexpr double kStageTolerance = 1e-3;

/// Gives the losses their own scale back when it goes.
struct Widening {
  System& system;
  double mu = 1;
  void set(double value) { system.setLossWidening(mu = value); }
  ~Widening() {
    if (mu != 1) system.setLossWidening(1);
  }
};

void checkGraduation(const Options& options) {
  if (!(options.graduation_factor > 1 && std::isfinite(options.graduation_factor))) {
    throw Error("slom.bad-option", "graduation_factor is " + std::to_string(options.graduation_factor) +
                                       "; pass a finite number above 1, such as 1.4");
  }
  if (options.stage_iterations < 1) {
    throw Error("slom.bad-option", "stage_iterations is " + std::to_string(options.stage_iterations) +
                                       "; pass a positive number, such as 2");
  }
}

class Run {
 public:
  Run(System& system, Algorithm& algorithm, const Options& options)
      : system_(system), algorithm_(&algorithm), options_(options), limits_(options) {}

  Summary go(SolveStatus& singular_at) {
    summary_.initial_rss = summary_.final_rss = system_.linearize();
    record({}, system_.gradientCosine());
    summary_.stop_reason = hasNothingToDo()                   ? StopReason::nothing_to_do
                           : options_.graduated_non_convexity ? graduate()
                                                              : iterate();
    if (summary_.stages > 0 && summary_.final_rss > summary_.initial_rss) warnOfRise();
    summary_.converged = isConverged(summary_.stop_reason);
    summary_.algorithm = algorithm_->name();
    summary_.seconds = secondsSinceStart();
    const PhaseSeconds now = system_.seconds();
    summary_.phases = {now.setup - before_.setup, now.linearize - before_.linearize, now.factorize - before_.factorize,
                       now.solve - before_.solve};
    singular_at = singular_at_;
    return std::move(summary_);
  }

 private:
  bool hasNothingToDo() {
    return system_.structure().system.unknowns() == 0 || system_.structure().residuals == 0;
  }

  /// Graduated non-convexity, as Options says. In addition mu never stays above what its first value's rule gives for
  /// the present residuals, so that a start far away does not cost stages once the first fits have come near.
  StopReason graduate() {
    Widening widening{system_};
    double most = 2 * system_.largestLossArgument();
    if (most < 0) {
      summary_.warnings.push_back(
          "graduated_non_convexity has nothing to graduate, as no measurement has a loss; pass one to "
          "insertMeasurement, such as slom::GemanMcClure(3)");
      return iterate();
    }
    for (double mu = std::max(most, 1.0);; mu = std::max(std::min(mu / options_.graduation_factor, most), 1.0)) {
      ++summary_.stages;
      widening.set(mu);
      limits_ = options_;
      if (mu == 1) {
        if (summary_.stages > 1) algorithm_->reset();
        return iterate();
      }
      limits_.max_iterations = std::min(options_.max_iterations, summary_.iterations + options_.stage_iterations);
      limits_.decrease_tolerance = std::max(options_.decrease_tolerance, kStageTolerance);
      const StopReason reason = iterate();
      if (endsTheFit(reason)) {
        widening.set(1);
        summary_.final_rss = system_.rss();
        return reason;
      }
      most = 2 * system_.largestLossArgument();
    }
  }

  void warnOfRise() {
    char text[64];
    std::snprintf(text, sizeof text, "at the RSS %g, above that of the start, %g", summary_.final_rss,
                  summary_.initial_rss);
    summary_.warnings.push_back(std::string("graduated non-convexity ended ") + text +
                                "; if the start was a good one, fit from it without graduated_non_convexity");
  }

  /// Whether a stage that stopped for this reason is the last one, though its losses are still widened.
  bool endsTheFit(StopReason reason) const {
    if (reason == StopReason::max_iterations) return summary_.iterations >= options_.max_iterations;
    return reason == StopReason::rank_deficient || reason == StopReason::not_finite;
  }

  StopReason iterate() {
    while (summary_.iterations < limits_.max_iterations) {
      system_.linearize();
      const double gradient = system_.gradientCosine();
      // A system without full rank is told about even when the RSS could not be smaller; the step finds out.
      StepOutcome outcome = algorithm_->step(system_, limits_);
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
    if (hasLittleDecrease(outcome, System::kRounding)) return StopReason::decrease;
    return system_.isNegligible(outcome.step, options_.step_tolerance) ? StopReason::step : StopReason::no_progress;
  }

  bool hasLittleDecrease(const StepOutcome& outcome, double least_tolerance = 0) const {
    const double little = std::max(limits_.decrease_tolerance, least_tolerance) * outcome.rss_before;
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
    line.widening = system_.lossWidening();
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
  Options limits_;  // of the stage
  Summary summary_;
  SolveStatus singular_at_;
  PhaseSeconds before_ = system_.seconds();
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace

Summary runAlgorithm(System& system, Algorithm& algorithm, const Options& options, SolveStatus& singular_at) {
  checkGraduation(options);
  return Run(system, algorithm, options).go(singular_at);
}

}  // namespace slom
