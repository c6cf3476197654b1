/// How large the errors of each kind of measurement are, from the residuals of a fit: variance components by restricted maximum likelihood.
///
///     const slom::VarianceComponents v = est.varianceComponents();
///     std::cout << v.report();
///     est.apply(v);        // from here on the stated standard deviations are those estimated
///     est.optimize();
///
/// Of kind k all stated covariances are taken to be wrong by one factor theta_k = f_k^2. The restricted likelihood is that of the residuals
/// alone, so that what the fit absorbs does not count as accuracy; its maximum is where |v_k|^2 = redundancy_k for each kind, v_k being the
/// residuals in units of the standard deviations so found. An error that the measurements of a group share is one component more.
///   source   Patterson and Thompson, "Recovery of inter-block information when block sizes are unequal", 1971; Foerstner, "Ein Verfahren
///            zur Schaetzung von Varianz- und Kovarianzkomponenten", 1979; Koch, "Parameter estimation and hypothesis testing in linear
///            models", 1999, section 3.6
/// docs/decisions/variance_components.md has the formulas.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "slom/analyze/clustered.hpp"

namespace slom {

/// An error that all measurements of a kind have in common within a group, beside one of their own: in each group one vector, normal, with
/// sigma^2 times the covariance that is stated of the measurements. All measurements of a group have residuals of the same length.
struct SharedError {
  std::string kind;  ///< whose error it is: the name of a kind, such as the label of the measurements
  ClusterBy by;      ///< which of them share it
  /// Where a measurement is in its group, a time or a distance: then the error changes along the group, and its correlation between places t and
  /// u is exp(-|t - u| / length). Without it the error is the same in the whole group.
  std::function<double(const ClusterItem&)> place{};
  double length = 0;  ///< in the units of `place`; positive where there is one
};

/// Which components are estimated, and how.
struct VarianceOptions {
  /// What makes a kind. Without it: the label that slom::named gave or, without one, the measurement's type. Measurements in no group
  /// are taken as stated.
  std::optional<ClusterBy> by{};
  /// Kinds that are estimated; all others are taken as stated. Empty: all but priors (Estimator::prior and GaussianPrior), which state
  /// what is known.
  std::vector<std::string> kinds{};
  std::vector<SharedError> shared{};
  int max_iterations = 200;
  /// Largest relative change of a variance by the last iteration.
  double tolerance = 1e-9;
};

/// The errors of one kind of measurements, or those that groups of them share.
struct VarianceComponent {
  std::string name;        ///< `tape`, or `tape, shared by day`
  bool is_shared = false;  ///< an error of SharedError
  int measurements = 0;    ///< or groups, for a shared error (places in them, where it changes along groups)
  int residuals = 0;       ///< scalar ones; for a shared error its unknowns in all groups
  double redundancy =
      0;  ///< of these residuals, at the variances found: the part that the fit does not absorb
  bool is_estimated =
      true;  ///< false: factor is that of the stated standard deviations, 1, or 0 for a shared error
  std::string reason;  ///< why it is not estimated

  /// Standard deviation over the stated one; of a shared error its own, in units of the stated ones.
  double factor = 1;
  /// Of the factor, from the restricted likelihood's information; NaN where the factor is 0 or not estimated.
  double standard_deviation = 0;
  /// With SharedError::length: derivative of the restricted log-likelihood by the logarithm of that length. Where it is above 0 a longer one
  /// fits better, and at the best one it is 0.
  double length_slope = 0;
  /// Degrees of freedom of factor^2, 2 factor^4 / Var(factor^2): the redundancy where the kind is alone.
  double dof = 0;

  /// Limits of the interval that holds the factor with this probability, by chi-square with `dof` degrees of freedom.
  std::pair<double, double> interval(double probability = 0.95) const;
};

/// Factors of stated standard deviations. The problem is as before; Estimator::apply takes them over.
struct VarianceComponents {
  bool converged = false;
  int iterations = 0;
  std::string message;  ///< why the iteration ended
  /// Kinds in the order in which they came first, then shared errors.
  std::vector<VarianceComponent> components;
  /// By how many of its standard deviations the value that moves most would move with these weights.
  double largest_move = 0;
  /// Sentences: what could not be told apart, what was taken as stated.
  std::vector<std::string> notes;

  /// Correlation of the estimates of components i and j; 0 where one is not estimated.
  double correlation(int i, int j) const;
  /// The component with this name; throws [slom.no-component].
  const VarianceComponent& at(std::string_view name) const;
  /// A table of the components, and the notes.
  std::string report() const;

  struct Assignment;
  std::shared_ptr<const Assignment> assignment;  ///< for Estimator::apply
  std::vector<double> correlations;              ///< by pair of components
};

}  // namespace slom
