/// Options of a fit, what happens in each iteration, and what came out.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "mtk/detail/cpp20.hpp"

namespace slom {

/// Why a fit ended.
enum class StopReason {
  gradient,        ///< converged: the residual is orthogonal to all columns of J
  decrease,        ///< converged: neither the model nor the last step promises a smaller RSS
  step,            ///< converged: the last step moved nothing
  nothing_to_do,   ///< no unknowns, or no measurements
  max_iterations,  ///< not converged
  no_progress,  ///< not converged: no step, however short, makes the RSS smaller, though the linear model promises it
  rank_deficient,  ///< not converged: the measurements do not determine all unknowns
  not_finite,      ///< not converged: the step led to values where a residual is not finite
  time_limit,      ///< not converged: Options::max_seconds have passed
  interrupted      ///< not converged: Options::should_stop or Options::observer said so
};

/// A few words: "relative decrease below tolerance".
const char* toString(StopReason reason);
/// Whether the fit has converged with this reason.
bool isConverged(StopReason reason);

/// One line of progress.
struct IterationRecord {
  int iteration = 0;      ///< 0 is the start
  std::string algorithm;  ///< that made the step
  double rss = 0;         ///< after the step: sum of squared whitened residuals, with losses the robust cost;
                          ///< while graduating that of the losses scaled for the stage
  double relative_decrease = 0;  ///< (old - new) / old; negative when the RSS grew
  double gradient = 0;           ///< max_i |g_i| / (|J_i| |r|), where the step started
  double step = 0;     ///< max_i |d_i| |J_i|: the longest way, in standard deviations of that unknown alone
  double damping = 0;  ///< Levenberg-Marquardt's mu, dog leg's radius
  int trials = 1;      ///< steps tried in this iteration
  double graduation = 1;  ///< mu of the stage of graduated non-convexity; 1: the losses as they are
  double seconds = 0;     ///< since the start of optimize()
};

/// What an observer may return.
enum class FitControl { go_on, stop };

/// Called after each iteration: any function of an IterationRecord that returns nothing or a FitControl.
class Observer {
 public:
  Observer() = default;
  /// None.
  Observer(std::nullptr_t) {}  // NOLINT(google-explicit-constructor): none
  /// From a function of a const IterationRecord& that returns nothing or a FitControl, implicitly.
  template <class F>
    requires(!std::is_same_v<F, Observer> && requires(F& f, const IterationRecord& record) { f(record); })
  Observer(F f) {  // NOLINT(google-explicit-constructor): options.observer = [](const auto& record) { ... };
    using Result = decltype(f(std::declval<const IterationRecord&>()));
    static_assert(std::is_void_v<Result> || std::is_same_v<Result, FitControl>,
                  "slom: an observer returns nothing, or FitControl::go_on or FitControl::stop");
    if constexpr (std::is_same_v<F, std::function<void(const IterationRecord&)>>) {
      if (!f) return;
    }
    if constexpr (std::is_void_v<Result>) {
      call_ = [f = std::move(f)](const IterationRecord& record) mutable {
        f(record);
        return FitControl::go_on;
      };
    } else {
      call_ = std::move(f);
    }
  }

  explicit operator bool() const { return bool(call_); }
  FitControl operator()(const IterationRecord& record) const { return call_(record); }

 private:
  std::function<FitControl(const IterationRecord&)> call_;
};

/// A fit has converged when one of the first three tests holds, and the fourth with it. All use the decrease that the linear
/// model predicts without damping: a short step is not convergence.
struct Options {
  /// Cosine of the angle between the residual and each column of J: max_i |g_i| / (|J_i| |r|). More, Garbow and
  /// Hillstrom, "User guide for MINPACK-1", 1980, `gtol`.
  double gradient_tolerance = 1e-10;
  /// Actual and predicted decrease of the RSS, relative to the RSS; ibid., `ftol`.
  double decrease_tolerance = 1e-12;
  /// |d_i| relative to |x_i| (1 for angles) plus the standard deviation of that unknown alone; cf. ibid., `xtol`.
  double step_tolerance = 1e-10;
  /// How far it may still be to the solution in standard deviations, sqrt(g^T H^-1 g), H = J^T J, g = J^T r: beside a large
  /// RSS of some measurements the others are not forgotten. With Sigma::estimated in those that chi2PerDof() gives.
  /// Infinite, for residuals in units without known standard deviations: the other three alone, and decrease_tolerance looks at
  /// damped steps, too, unless one was refused, as Ceres' function_tolerance does.
  double deviation_tolerance = 1e-8;
  /// kByTheSize: 100000 / unknowns, but at least 100 and at most 10000.
  int max_iterations = kByTheSize;
  static constexpr int kByTheSize = -1;
  /// The fit ends after this time [s], within an iteration too, with the best values reached.
  double max_seconds = std::numeric_limits<double>::infinity();
  /// Asked before each trial of a step, by the thread that called optimize(); true ends the fit with the best values reached.
  std::function<bool()> should_stop{};
  /// Where Gauss-Newton steps lead uphill, take them back, go on with Levenberg-Marquardt, and return when its steps succeed.
  bool fall_back = true;
  /// For bad starts and gross outliers: fits first with the scales of all losses multiplied by sqrt(mu), so that they are nearly
  /// squares for all residuals and the start hardly matters, then in stages of smaller and smaller mu, each from the
  /// last one's values, until mu = 1; only that last stage must converge. Without losses there is nothing to graduate,
  /// and a warning of the summary says so. All stages count towards max_iterations.
  ///   source   Yang, Antonante, Tzoumas and Carlone, "Graduated non-convexity for robust spatial perception", RA-L
  ///            2020: mu starts at max 2 |W r|^2 / c^2 and is divided by 1.4. For GemanMcClure this is their surrogate,
  ///            mu c^2 r^2 / (mu c^2 + r^2), itself; for the other losses it generalises by the scale.
  bool graduated_non_convexity = false;
  /// What mu is divided by from stage to stage, > 1.
  double graduation_factor = 1.4;
  /// Iterations of each stage but the last, at most.
  int stage_iterations = 2;
  /// A fit with no more unknowns than this ends with standard deviations and correlations of all of them in the summary.
  int most_parameters = 40;
  /// Called after each iteration, and once before the first. FitControl::stop ends the fit with the best values reached.
  Observer observer{};
};

/// What one loss did to the measurements of a group.
struct LossSummary {
  std::string loss;       ///< `Huber(1.345)`
  int measurements = 0;   ///< that have it
  int down_weighted = 0;  ///< those with a weight below 1/2 at the end
  int weightless = 0;     ///< those with weight 0
};

/// The measurements with one label or of one type: their number, and their part of the RSS.
struct GroupSummary {
  std::string name;  ///< the label, or the measurement type
  int measurements = 0;
  int residuals = 0;  ///< sum of the lengths of their residuals
  double initial_rss = 0;
  double final_rss = 0;
  double redundancy =
      -1;  ///< what chi-square is on average, when the summary has parameters; -1: not computed
  std::string
      derivatives;  ///< "exact" (dual numbers), "given" (the functor's own) or "numeric" (differences)
  std::vector<LossSummary> losses;  ///< empty when no measurement of the group has one
};

/// Where the time of a fit went [s].
struct PhaseSeconds {
  double setup = 0;      ///< the graph of variables, the order of elimination, the layout of the factor
  double linearize = 0;  ///< residuals and derivatives, and summing up the normal equations
  double factorize = 0;
  double solve = 0;  ///< with the factor
};

/// A fitted component.
struct ParameterSummary {
  std::string name;
  double value =
      0;  ///< its coordinate; of a rotation an entry of its rotation vector, in the plane its angle [rad]; NaN where it has neither
  std::string text;  ///< in place of a value, a direction's unit vector, with its first component
  double standard_deviation = 0;  ///< in the tangent space
  double clustered =
      std::numeric_limits<double>::quiet_NaN();  ///< the same by Clustered::addTo; NaN: not filled in
  double clustered_dof = 0;                      ///< degrees of freedom of that
};

/// Two components whose errors are strongly correlated.
struct CorrelationSummary {
  std::string a, b;  ///< names of components
  double correlation = 0;
};

/// Whether measurements state their uncertainty; those that do not have 1 in each component.
enum class StatedNoise { all, some, none };

/// How a fit ended, and what came out of it.
struct Summary {
  bool converged = false;
  StopReason stop_reason = StopReason::nothing_to_do;
  std::string message;                ///< the stop reason in a sentence, with names where something is wrong
  std::vector<std::string> warnings;  ///< variables without measurements, changes of the algorithm
  std::string algorithm;              ///< the one at the end
  std::string solver;                 ///< what solved the linear systems
  int iterations = 0;
  int stages = 0;           ///< begun, of graduated non-convexity; 0: not graduated
  int variables = 0;        ///< optimised ones
  int measurements = 0;     ///< number of scalar residuals
  int unknowns = 0;         ///< without those at an active bound
  int free_directions = 0;  ///< which no measurement determines; counted up to kMostCounted unknowns
  int redundancy = 0;       ///< measurements - unknowns + free_directions
  bool is_free_network =
      false;  ///< of all best values these are nearest to the start: FreeGauge::inner_constraints
  bool sigma_is_estimated = false;  ///< Sigma::estimated: covariances are multiplied by chi2PerDof()
  StatedNoise stated_noise = StatedNoise::all;
  std::vector<std::string>
      active_bounds;  ///< `camera.k3 is at its upper bound 0.5`; covariances hold on that condition
  double initial_rss = 0;
  double final_rss = 0;
  /// Fits of more unknowns have so much redundancy that a gauge does not count, or report free_directions = 0 though there are some;
  /// diagnose() counts them.
  static constexpr int kMostCounted = 5000;
  double seconds = 0;
  PhaseSeconds phases;  ///< parts of `seconds`
  std::vector<GroupSummary> groups;
  std::vector<ParameterSummary> parameters;  ///< when there are no more than Options::most_parameters
  std::vector<std::string>
      undetermined;  ///< without `parameters`: what no measurement determines; with them: what is hardly determined
  int parameters_not_shown = 0;  ///< when there are more; Estimator::addParametersTo fills them in
  bool has_rotations = false;    ///< some of the parameters are components of rotations in space
  std::vector<std::string> clustered_notes;      ///< what limits the clustered standard deviations
  std::vector<CorrelationSummary> correlations;  ///< the strongest of these parameters, from 0.95 on
  int correlations_not_shown = 0;                ///< further ones from 0.95 on
  std::vector<IterationRecord> trace;

  // Compiled once, not in every file that fits something.
  Summary();
  ~Summary();
  Summary(const Summary&);
  Summary(Summary&&) noexcept;
  Summary& operator=(const Summary&);
  Summary& operator=(Summary&&) noexcept;

  /// final_rss / redundancy: near 1 when the stated uncertainties are right. NaN without redundancy. With losses it is
  /// smaller, as they make final_rss smaller than the sum of squares.
  double chi2PerDof() const;
  /// Whether any measurement has a robust loss.
  bool hasLosses() const;
  /// What was fitted and how well, to be read at a glance.
  std::string report() const;
  /// The same for programs: an object of JSON (RFC 8259) in one line, in UTF-8. Numbers have all their digits, null stands for those that
  /// are not finite or not known. Keys: docs/fitting.md.
  std::string json() const;
};

}  // namespace slom
