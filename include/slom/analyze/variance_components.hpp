/// Variance components: the size of the errors of each kind of measurement, from the residuals of a fit, by restricted
/// maximum likelihood.
///
///     const slom::VarianceComponents v = slom::varianceComponents(est);
///     std::cout << v;
///     slom::apply(v, est);     // sets the stated standard deviations to the estimated ones
///     est.optimize();
///
/// All stated covariances of kind k are assumed to be wrong by one factor theta_k = f_k^2. The restricted likelihood
/// accounts for the unknowns: errors that the fit absorbs do not make measurements look more accurate. At its maximum,
/// |v_k|^2 = redundancy_k for each kind, with v_k the residuals in units of the estimated standard deviations. An
/// error that the measurements of a group share is a further component. docs/decisions/variance_components.md has the
/// formulas.
///   source   Patterson and Thompson, "Recovery of inter-block information when block sizes are unequal", 1971;
///            Foerstner, "Ein Verfahren zur Schaetzung von Varianz- und Kovarianzkomponenten", 1979; Koch, "Parameter
///            estimation and hypothesis testing in linear models", 1999, section 3.6
#pragma once

#include <functional>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "slom/analyze/clustered.hpp"

namespace slom {

/// An error that all measurements of a kind share within a group, in addition to their own errors. It is one normal
/// vector for each group, with sigma^2 times the stated covariance of the measurements. All measurements of a group
/// must have residuals of the same length.
struct SharedError {
  std::string kind;  ///< name of the kind with this error, such as the label of its measurements
  ClusterBy by;      ///< groups that share it
  /// Position of a measurement in its group, a time or a distance. If given, the error changes along the group, and its
  /// correlation between positions t and u is exp(-|t - u| / length). Otherwise the error is the same in the whole
  /// group.
  std::function<double(const ClusterItem&)> place{};
  double length = 0;  ///< in the units of `place`; positive if `place` is given
};

/// Options: which components are estimated, and how.
struct VarianceOptions {
  /// Grouping into kinds. If not given, a kind is the label of slom::named or, without a label, the measurement's type.
  /// Measurements in no group are taken as stated.
  std::optional<ClusterBy> by{};
  /// Kinds to estimate; all others are taken as stated. Empty: all except priors (Estimator::prior and GaussianPrior),
  /// which state prior knowledge.
  std::vector<std::string> kinds{};
  std::vector<SharedError> shared{};
  int max_iterations = 200;
  /// Largest relative change of a variance in the last iteration.
  double tolerance = 1e-9;
};

/// The errors of one kind of measurements, or the shared errors of groups.
struct VarianceComponent {
  std::string name;        ///< `tape`, or `tape, shared by day`
  bool is_shared = false;  ///< true for an error of SharedError
  /// Number of measurements. For a shared error the number of groups, or of places in them if the error changes along
  /// groups.
  int measurements = 0;
  int residuals = 0;  ///< scalar residuals; for a shared error its unknowns in all groups
  /// Redundancy of these residuals at the estimated variances: the part that the fit does not absorb.
  double redundancy = 0;
  /// If false, `factor` is not an estimate: 1, as stated, or 0 for a shared error.
  bool is_estimated = true;
  std::string reason;  ///< reason why it is not estimated

  /// Standard deviation divided by the stated one. For a shared error its standard deviation in units of the stated
  /// ones.
  double factor = 1;
  /// Standard deviation of the factor, from the information of the restricted likelihood; NaN if the factor is 0 or not
  /// estimated.
  double standard_deviation = 0;
  /// Derivative of the restricted log-likelihood with respect to the logarithm of SharedError::length, if given. If it
  /// is positive, a larger length fits better. At the best length it is 0.
  double length_slope = 0;
  /// Degrees of freedom of factor^2: 2 factor^4 / Var(factor^2). For a kind alone this is the redundancy.
  double dof = 0;

  /// Returns the limits of the interval that contains the factor with this probability, by chi-square with `dof`
  /// degrees of freedom.
  std::pair<double, double> interval(double probability = 0.95) const;
};

/// Factors of the stated standard deviations. The problem is unchanged until slom::apply.
struct VarianceComponents {
  bool converged = false;
  int iterations = 0;
  std::string message;  ///< reason for the end of the iteration
  /// Kinds in the order of their first measurement, then shared errors.
  std::vector<VarianceComponent> components;
  /// Largest move of a value with these weights, in its standard deviations.
  double largest_move = 0;
  /// Sentences on what could not be separated and what was taken as stated.
  std::vector<std::string> notes;

  /// Returns the correlation of the estimates of components i and j; 0 if one is not estimated.
  double correlation(int i, int j) const;
  /// Returns the component with this name. Throws [slom.no-component].
  const VarianceComponent& at(std::string_view name) const;
  /// Returns a table of the components, and the notes.
  std::string report() const;

  struct Assignment;
  std::shared_ptr<const Assignment> assignment;  ///< for slom::apply
  std::vector<double> correlations;              ///< for pairs of components
};

/// Prints report().
std::ostream& operator<<(std::ostream& os, const VarianceComponents& components);

/// Estimates the size of the errors of each kind of measurement, relative to the stated ones, and of the errors that
/// groups share. Works at the values of the fit and keeps them. Throws [slom.not-a-minimum], [slom.no-component],
/// [slom.components-with-loss], [slom.no-groups], [slom.bad-group], [slom.bad-option] and as Estimator::covariance
/// does.
VarianceComponents varianceComponents(const Estimator& est);
VarianceComponents varianceComponents(const Estimator& est, const VarianceOptions& options);
/// Multiplies the stated standard deviations of each kind by its factor, for all later computations. Call optimize()
/// afterwards. Shared errors are not changed. To include them in the fit, add a variable with a prior for each group.
/// Throws [slom.stale-components].
void apply(const VarianceComponents& components, Estimator& est);

}  // namespace slom
