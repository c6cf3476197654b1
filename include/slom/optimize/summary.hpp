/// Options of a fit, record of each iteration, and summary.
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

/// Reason for the end of a fit.
enum class StopReason {
  gradient,        ///< converged: the residual is orthogonal to all columns of J
  decrease,        ///< converged: neither the model nor the last step promises a smaller RSS
  step,            ///< converged: the last step was negligible
  nothing_to_do,   ///< there are no unknowns or no measurements
  max_iterations,  ///< not converged
  /// Not converged: no step, however short, reduces the RSS, although the linear model promises a reduction.
  no_progress,
  rank_deficient,  ///< not converged: the measurements do not determine all unknowns
  not_finite,      ///< not converged: a residual is not finite at the values after a step
  time_limit,      ///< not converged: Options::max_seconds have passed
  interrupted      ///< not converged: Options::should_stop or Options::observer stopped the fit
};

/// Returns a few words: "relative decrease below tolerance".
const char* toString(StopReason reason);
/// Returns whether a fit with this stop reason has converged.
bool isConverged(StopReason reason);

/// One line of progress.
struct IterationRecord {
  int iteration = 0;      ///< 0 is the start
  std::string algorithm;  ///< algorithm that made the step
  /// RSS after the step: sum of squared whitened residuals, with losses the robust cost. While graduating, the losses
  /// are scaled for the stage.
  double rss = 0;
  double relative_decrease = 0;  ///< (old - new) / old; negative if the RSS grew
  double gradient = 0;           ///< max_i |g_i| / (|J_i| |r|) at the start of the step
  /// max_i |d_i| |J_i|: the longest move, in standard deviations of that unknown alone.
  double step = 0;
  double damping = 0;     ///< Levenberg-Marquardt's mu, dog leg's radius
  int trials = 1;         ///< steps tried in this iteration
  double graduation = 1;  ///< mu of the stage of graduated non-convexity; 1: the given losses
  double seconds = 0;     ///< since the start of optimize()
};

/// Return value of an observer.
enum class FitControl { go_on, stop };

/// A function that the fit calls after each iteration. It takes an IterationRecord and returns nothing or a FitControl.
class Observer {
 public:
  Observer() = default;
  /// Creates no observer.
  Observer(std::nullptr_t) {}  // NOLINT(google-explicit-constructor): none
  /// Converts a function of a const IterationRecord& that returns nothing or a FitControl, implicitly.
  template <class F>
    requires(!std::is_same_v<F, Observer> && requires(F& f, const IterationRecord& record) { f(record); })
  Observer(F f) {  // NOLINT(google-explicit-constructor): options.observer = [](const auto& record) { ... };
    using Result = decltype(f(std::declval<const IterationRecord&>()));
    static_assert(std::is_void_v<Result> || std::is_same_v<Result, FitControl>,
                  "slom: an observer must return nothing, FitControl::go_on or FitControl::stop");
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

/// Options of a fit. A fit has converged if one of the first three tests holds together with the fourth. All tests use
/// the decrease that the linear model predicts without damping, so a short step does not count as convergence.
struct Options {
  /// Gradient test: cosine of the angle between the residual and each column of J, max_i |g_i| / (|J_i| |r|). More,
  /// Garbow and Hillstrom, "User guide for MINPACK-1", 1980, `gtol`.
  double gradient_tolerance = 1e-10;
  /// Decrease test: actual and predicted decrease of the RSS, relative to the RSS; ibid., `ftol`.
  double decrease_tolerance = 1e-12;
  /// Step test: |d_i| relative to |x_i| (1 for angles) plus the standard deviation of that unknown alone; cf. ibid.,
  /// `xtol`.
  double step_tolerance = 1e-10;
  /// Distance test: maximum remaining distance to the solution in standard deviations, sqrt(g^T H^-1 g), H = J^T J, g =
  /// J^T r. This test keeps a large RSS of some measurements from hiding the others. With Sigma::estimated, the
  /// standard deviations are those from chi2PerDof(). For residuals in units without known standard deviations, set it
  /// to infinity. Then only the other three tests apply, and decrease_tolerance also looks at damped steps, unless one
  /// was refused, like Ceres' function_tolerance.
  double deviation_tolerance = 1e-8;
  /// Maximum number of iterations. kByTheSize: 100000 / unknowns, but at least 100 and at most 10000.
  int max_iterations = kByTheSize;
  static constexpr int kByTheSize = -1;
  /// Time limit [s]. The fit then ends with the best values reached, also within an iteration.
  double max_seconds = std::numeric_limits<double>::infinity();
  /// A function called before each trial of a step, by the thread that called optimize(). If it returns true, the fit
  /// ends with the best values reached.
  std::function<bool()> should_stop{};
  /// If true, Gauss-Newton steps that lead uphill are undone. The fit continues with Levenberg-Marquardt and returns to
  /// Gauss-Newton when its steps succeed.
  bool fall_back = true;
  /// Graduated non-convexity, for bad starts and gross outliers. The fit first multiplies the scales of all losses by
  /// sqrt(mu). The losses are then nearly squares for all residuals, and the start hardly matters. Stages with smaller
  /// and smaller mu follow, each from the values of the last one, until mu = 1. Only the last stage must converge. All
  /// stages count towards max_iterations. Without losses there is nothing to graduate, and the summary has a warning.
  ///   source   Yang, Antonante, Tzoumas and Carlone, "Graduated non-convexity for robust spatial perception", RA-L
  ///            2020: mu starts at max 2 |W r|^2 / c^2 and is divided by 1.4. For GemanMcClure this is their surrogate,
  ///            mu c^2 r^2 / (mu c^2 + r^2), itself; for the other losses it generalises by the scale.
  bool graduated_non_convexity = false;
  /// Divisor of mu from stage to stage, > 1.
  double graduation_factor = 1.4;
  /// Maximum number of iterations of each stage except the last.
  int stage_iterations = 2;
  /// Largest number of unknowns for which the summary lists standard deviations and correlations of all unknowns.
  int most_parameters = 40;
  /// A function called after each iteration, and once before the first. FitControl::stop ends the fit with the best
  /// values reached.
  Observer observer{};
};

/// Effect of one loss on the measurements of a group.
struct LossSummary {
  std::string loss;       ///< `Huber(1.345)`
  int measurements = 0;   ///< measurements with this loss
  int down_weighted = 0;  ///< measurements with a weight below 1/2 at the end
  int weightless = 0;     ///< measurements with weight 0
};

/// The measurements with one label or of one type: their number and their part of the RSS.
struct GroupSummary {
  std::string name;  ///< the label, or the measurement type
  int measurements = 0;
  int residuals = 0;  ///< total number of scalar residuals
  double initial_rss = 0;
  double final_rss = 0;
  /// Expected value of chi-square. Computed if the summary has parameters; -1: not computed.
  double redundancy = -1;
  /// Source of the derivatives: "exact" (dual numbers), "given" (by the functor) or "numeric" (differences).
  std::string derivatives;
  std::vector<LossSummary> losses;  ///< empty if no measurement of the group has a loss
};

/// Time spent in each phase of a fit [s].
struct PhaseSeconds {
  double setup = 0;      ///< the graph of variables, the order of elimination, the layout of the factor
  double linearize = 0;  ///< residuals, derivatives and the sum of the normal equations
  double factorize = 0;
  double solve = 0;  ///< solutions with the factor
};

/// A fitted component.
struct ParameterSummary {
  std::string name;
  /// Coordinate of the component. For a rotation in space an entry of its rotation vector, in the plane its angle
  /// [rad]. NaN if there is neither.
  double value = 0;
  std::string text;  ///< for a direction its unit vector, in place of a value, with its first component
  double standard_deviation = 0;  ///< in the tangent space
  /// Clustered standard deviation, filled in by Clustered::addTo; NaN: not filled in.
  double clustered = std::numeric_limits<double>::quiet_NaN();
  double clustered_dof = 0;  ///< degrees of freedom of `clustered`
};

/// Two components whose errors are strongly correlated.
struct CorrelationSummary {
  std::string a, b;  ///< names of components
  double correlation = 0;
};

/// Whether measurements state their uncertainty. The others have standard deviation 1 in each component.
enum class StatedNoise { all, some, none };

/// End of a fit and its results.
struct Summary {
  bool converged = false;
  StopReason stop_reason = StopReason::nothing_to_do;
  /// The stop reason in a sentence, with the names concerned if something is wrong.
  std::string message;
  std::vector<std::string> warnings;  ///< variables without measurements, changes of the algorithm
  std::string algorithm;              ///< algorithm at the end
  std::string solver;                 ///< solver of the linear systems
  int iterations = 0;
  int stages = 0;        ///< stages of graduated non-convexity that were begun; 0: not graduated
  int variables = 0;     ///< optimised variables
  int measurements = 0;  ///< number of scalar residuals
  int unknowns = 0;      ///< without unknowns at an active bound
  int free_directions =
      0;               ///< directions that no measurement determines; counted up to kMostCounted unknowns
  int redundancy = 0;  ///< measurements - unknowns + free_directions
  /// True if, of all best values, these are the nearest to the start: FreeGauge::inner_constraints.
  bool is_free_network = false;
  bool sigma_is_estimated = false;  ///< Sigma::estimated: covariances are multiplied by chi2PerDof()
  StatedNoise stated_noise = StatedNoise::all;
  /// Sentences such as `camera.k3 is at its upper bound 0.5`. Covariances are conditional on these bounds.
  std::vector<std::string> active_bounds;
  double initial_rss = 0;
  double final_rss = 0;
  /// Largest number of unknowns for which free_directions is counted. Larger fits have so much redundancy that a gauge
  /// does not matter. They may report free_directions = 0 although there are some; slom::diagnose counts them.
  static constexpr int kMostCounted = 5000;
  double seconds = 0;
  PhaseSeconds phases;  ///< parts of `seconds`
  std::vector<GroupSummary> groups;
  std::vector<ParameterSummary> parameters;  ///< filled if there are at most Options::most_parameters
  /// If `parameters` is empty, what no measurement determines; otherwise what is hardly determined.
  std::vector<std::string> undetermined;
  /// Number of parameters if there are more than Options::most_parameters. Estimator::addParametersTo fills them in.
  int parameters_not_shown = 0;
  bool has_rotations = false;                ///< some of the parameters are components of rotations in space
  std::vector<std::string> clustered_notes;  ///< limits of the clustered standard deviations
  std::vector<CorrelationSummary> correlations;  ///< strongest correlations of these parameters, from 0.95 on
  int correlations_not_shown = 0;                ///< number of further correlations from 0.95 on
  std::vector<IterationRecord> trace;

  // Compiled once, not in every file that runs a fit.
  Summary();
  ~Summary();
  Summary(const Summary&);
  Summary(Summary&&) noexcept;
  Summary& operator=(const Summary&);
  Summary& operator=(Summary&&) noexcept;

  /// Returns final_rss / redundancy, near 1 if the stated uncertainties are right; NaN without redundancy. With losses
  /// the value is smaller, because they make final_rss smaller than the sum of squares.
  double chi2PerDof() const;
  /// Returns whether any measurement has a robust loss.
  bool hasLosses() const;
  /// Returns a short report: what was fitted and how well.
  std::string report() const;
  /// Returns the summary for programs: a JSON object (RFC 8259) in one line, in UTF-8. Numbers have all their digits.
  /// Numbers that are not finite or not known are null. Keys: docs/summary.md.
  std::string json() const;
};

}  // namespace slom
