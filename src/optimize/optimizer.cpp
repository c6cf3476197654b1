#include "slom/optimize/optimizer.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "base/words.hpp"
#include "optimize/convergence.hpp"
#include "problem/value_snapshot.hpp"
#include "slom/optimize/system.hpp"

namespace slom {

const char* toString(StopReason reason) {
  switch (reason) {
    case StopReason::gradient:
      return "gradient below tolerance";
    case StopReason::decrease:
      return "relative decrease below tolerance";
    case StopReason::step:
      return "step below tolerance";
    case StopReason::nothing_to_do:
      return "nothing to optimize";
    case StopReason::max_iterations:
      return "iteration limit reached";
    case StopReason::no_progress:
      return "no step makes the RSS smaller";
    case StopReason::rank_deficient:
      return "rank deficient";
    case StopReason::not_finite:
      return "a residual became not finite";
    case StopReason::time_limit:
      return "time limit reached";
    case StopReason::interrupted:
      return "interrupted";
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
  return std::any_of(groups.begin(), groups.end(),
                     [](const GroupSummary& group) { return !group.losses.empty(); });
}

namespace {

/// A stage of graduated non-convexity is over when the RSS falls by less than this, relatively.
constexpr double kStageTolerance = 1e-3;
/// First damping where long steps have failed.
constexpr double kCautiousDamping = 1e3;

/// Gives the losses their own scale back when it goes.
struct Graduation {
  System& system;
  double mu = 1;
  void set(double value) { system.setLossGraduation(mu = value); }
  ~Graduation() {
    if (mu != 1) system.setLossGraduation(1);
  }
};

void checkGraduation(const Options& options) {
  if (!(options.graduation_factor > 1 && std::isfinite(options.graduation_factor))) {
    throw Error("slom.bad-option", "graduation_factor is " + number(options.graduation_factor, 6) +
                                       "; pass a finite number above 1, such as 1.4");
  }
  if (options.stage_iterations < 1) {
    throw Error("slom.bad-option", "stage_iterations is " + std::to_string(options.stage_iterations) +
                                       "; pass a positive number, such as 2");
  }
}

void checkOptions(const Options& options) {
  if (options.max_iterations < 0 && options.max_iterations != Options::kByTheSize) {
    throw Error("slom.bad-option", "max_iterations is " + std::to_string(options.max_iterations) +
                                       "; pass 0 or more, or Options::kByTheSize");
  }
  if (!(options.max_seconds > 0)) {
    throw Error("slom.bad-option",
                "max_seconds is " + number(options.max_seconds, 6) + "; pass a positive number");
  }
  if (!(options.deviation_tolerance >= 0)) {
    throw Error("slom.bad-option", "deviation_tolerance is " + number(options.deviation_tolerance, 6) +
                                       "; pass 0 or more, such as 1e-8, or infinity for none");
  }
}

/// Many iterations where each is cheap.
int iterationLimit(const Options& options, int unknowns) {
  constexpr int work = 100'000, least = 100, most = 10'000;
  return options.max_iterations == Options::kByTheSize ? std::clamp(work / std::max(1, unknowns), least, most)
                                                       : options.max_iterations;
}

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

  /// Graduated non-convexity, as Options says. In addition mu never stays above what its first value's rule
  /// gives for the present residuals, so that a start far away does not cost stages once the first fits have
  /// come near.
  StopReason graduate() {
    Graduation graduation{system_};
    double most = 2 * system_.largestLossArgument();
    if (most < 0) {
      summary_.warnings.push_back(
          "graduated_non_convexity has nothing to graduate, as no measurement has a loss; pass one to "
          "insertMeasurement, such as slom::GemanMcClure(3)");
      return iterate();
    }
    for (double mu = std::max(most, 1.0);;
         mu = std::max(std::min(mu / options_.graduation_factor, most), 1.0)) {
      ++summary_.stages;
      graduation.set(mu);
      limits_ = options_;
      limits_.max_iterations = most_iterations_;
      if (mu == 1) {
        if (summary_.stages > 1) algorithm_->reset();
        return iterate();
      }
      limits_.max_iterations = std::min(most_iterations_, summary_.iterations + options_.stage_iterations);
      limits_.decrease_tolerance = std::max(options_.decrease_tolerance, kStageTolerance);
      const StopReason reason = iterate();
      if (endsTheFit(reason)) {
        graduation.set(1);
        summary_.final_rss = system_.rss();
        return reason;
      }
      most = 2 * system_.largestLossArgument();
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

  StopReason iterate() {
    bool is_fresh = false;     // nothing taken since the algorithm was reset where it was stuck
    Options limits = limits_;  // for its steps
    const StopReason reason = [&] {
      while (summary_.iterations < limits_.max_iterations) {
        if (const auto stop = interruption()) return *stop;
        system_.linearize();
        const double gradient = system_.orthogonality();
        // A system without full rank is told about even when the RSS could not be smaller; the step finds
        // out.
        const StepOutcome outcome = algorithm_->step(system_, limits);
        if (outcome.kind == StepOutcome::Kind::stopped) return *interruption();
        ++summary_.iterations;
        summary_.final_rss = outcome.rss_after;
        if (!outcome.event.empty()) {
          summary_.warnings.push_back("iteration " + std::to_string(summary_.iterations) + ": " +
                                      outcome.event);
        }
        record(outcome, gradient);
        switch (outcome.kind) {
          case StepOutcome::Kind::singular:
            singular_at_ = outcome.status;
            return StopReason::rank_deficient;
          case StepOutcome::Kind::not_finite:
            return StopReason::not_finite;
          case StepOutcome::Kind::stopped:
          case StepOutcome::Kind::stuck:
            if (const auto reason =
                    convergence_.whenStuck(gradient, limits_.decrease_tolerance, outcome.status.ok)) {
              return *reason;
            }
            if (!outcome.status.ok) {
              singular_at_ = outcome.status;
              return StopReason::rank_deficient;
            }
            if (convergence_.hasAdvanced()) {
              summary_.final_rss = system_.linearize();
              record({}, gradient);
              continue;
            }
            // What earlier steps taught may be what holds it, or that the algorithm took small promises for
            // none.
            if (is_fresh) return convergence_.isHidden() ? StopReason::decrease : StopReason::no_progress;
            algorithm_->reset();
            limits.decrease_tolerance = limits.deviation_tolerance = 0;
            is_fresh = true;
            continue;
          case StepOutcome::Kind::taken:
            is_fresh = false;
            break;
        }
        if (const auto reason = convergence_.afterStep(outcome, gradient, limits_.decrease_tolerance))
          return *reason;
        if (creeps(outcome)) {
          const auto reason = convergence_.whenStuck(system_.orthogonality(), limits_.decrease_tolerance);
          if (reason || !convergence_.hasAdvanced()) return reason.value_or(StopReason::no_progress);
          summary_.final_rss = system_.linearize();
        }
      }
      return StopReason::max_iterations;
    }();
    algorithm_->finish(system_);
    if (!isConverged(reason)) summary_.final_rss = system_.rss();
    return reason;
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
  Options limits_;  // of the stage
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
  checkOptions(options);
  checkGraduation(options);
  return Run(system, algorithm, options, sigma_is_estimated).go(singular_at);
}

}  // namespace slom
