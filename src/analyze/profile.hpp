/// Intervals by profile likelihood.
///   source   Venzon and Moolgavkar, "A method for computing profile-likelihood-based confidence intervals", 1988
#pragma once

#include <functional>
#include <string>

#include "slom/analyze/profile.hpp"

namespace slom {

class Problem;

/// Functions of the estimator that a profile needs.
struct ProfiledFit {
  std::function<double()> variance_factor;
  std::function<bool(double variance_factor)> is_at_minimum;  ///< at the current values
  std::function<double()> rss;                                ///< at the current values
  std::function<void(double*)> covariance;  ///< writes the variable's, dof x dof, at the current values
  std::function<double()> refit;            ///< fits all that is not fixed; returns the RSS
  /// Returns half the interval in stated standard deviations of the component, for a quadratic RSS.
  std::function<double(int component)> half_width;
};

/// Returns the interval of a component that is a coordinate, see slom::profile. Restores values, fixed components
/// and bounds, also if it throws.
ProfileInterval profileLikelihood(Problem& problem, const ProfiledFit& fit, int variable, int component);

/// Returns the component at `path`. Throws [slom.no-component] unless it is one component and a coordinate.
int profiledComponent(const Problem& problem, int variable, const std::string& path);
/// Returns whether the component is a coordinate of a vector, so that it has a profile.
bool isCoordinate(const Problem& problem, int variable, int component);

/// Throws [slom.bad-option] unless the probability is between 0 and 1.
void requireProbabilityOfProfile(double probability);

/// Returns the root of a function that grows with t > 0, is -1 at 0 and about (t / guess)^2 - 1. Searches up to about
/// 1000 guesses; infinite beyond. Returns `most` if f is not positive up to there; f is not evaluated beyond `most`.
double profileRoot(const std::function<double(double)>& f, double guess, double most);

}  // namespace slom
