/// Intervals by profile likelihood.
///   source   Venzon and Moolgavkar, "A method for computing profile-likelihood-based confidence intervals", 1988
#pragma once

#include <functional>
#include <string>

#include "slom/analyze/profile.hpp"

namespace slom {

class Problem;

/// What a profile asks of the estimator.
struct ProfiledFit {
  std::function<double()> variance_factor;
  std::function<bool(double variance_factor)> is_at_minimum;  ///< at the current values
  std::function<double()> rss;                                ///< likewise
  std::function<void(double*)> covariance;  ///< writes that of the variable, dof x dof; likewise
  std::function<double()> refit;            ///< fits all that is not fixed; returns the RSS
  /// How many stated standard deviations of the component half the interval is, where the RSS is quadratic.
  std::function<double(int component)> half_width;
};

/// The interval of a component that is a coordinate, see slom::profile. Values, fixed components and bounds are as before when it
/// returns or throws.
ProfileInterval profileLikelihood(Problem& problem, const ProfiledFit& fit, int variable, int component);

/// The component at `path`. Throws [slom.no-component] unless it is one, and a coordinate.
int profiledComponent(const Problem& problem, int variable, const std::string& path);
/// Whether the component is a coordinate of a vector, so that it has a profile.
bool isCoordinate(const Problem& problem, int variable, int component);

/// Throws [slom.bad-option] unless it is between 0 and 1.
void requireProbabilityOfProfile(double probability);

/// The root of a function that grows with t > 0, is -1 at 0 and about (t / guess)^2 - 1, up to 1000 guesses; infinite beyond.
/// `most` where the function, which is not evaluated beyond, is not positive up to there.
double profileRoot(const std::function<double(double)>& f, double guess, double most);

}  // namespace slom
