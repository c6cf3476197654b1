/// The confidence interval of one component by profile likelihood.
///
///     std::cout << slom::profile(est, oak, "x");    // 39.99 in [39.97, 40.01]
#pragma once

#include <iosfwd>
#include <string>

#include "mtk/detail/cpp20.hpp"

namespace slom {

class Clustered;
class Estimator;
class VariableHandle;

/// A confidence interval of a coordinate.
struct ProfileInterval {
  double value, lower, upper;
};

/// Prints the interval: `39.99 in [39.97, 40.01]`.
std::ostream& operator<<(std::ostream& os, const ProfileInterval& interval);

/// Returns the interval in which a component of the variable, a VarID, lies with this probability, by profile
/// likelihood. At the ends of the interval, the RSS of the best fit of all other components exceeds the minimum by the
/// quantile of chi-square. With Sigma::estimated, it exceeds the minimum by the square of Student's quantile for the
/// redundancy, times the variance factor (F(1, redundancy): Bates and Watts, "Nonlinear regression analysis", 1988,
/// section 6.1). If the RSS is not quadratic, use the interval instead of the standard deviation.
///
/// Works for coordinates of vectors, at the values of a fit, which are restored afterwards. An end that is not reached
/// within 1000 standard deviations is infinite. If the component's bound is reached first, the interval ends there. If
/// the component is at its bound, the interval is one-sided, from the bound inwards. A fixed component has width 0.
/// Throws [slom.not-a-minimum], [slom.bad-option], [slom.no-component] and as Estimator::covariance does.
///   source   Venzon and Moolgavkar, "A method for computing profile-likelihood-based confidence intervals", 1988
ProfileInterval profile(Estimator& est, const VariableHandle& id, const std::string& path,
                        double probability = 0.95);
/// Returns the interval of a variable that has one component.
ProfileInterval profile(Estimator& est, const VariableHandle& id, double probability = 0.95);
/// Returns the interval for errors that measurements share. At its ends, the RSS of the best fit of all other
/// components exceeds the minimum by (t s / s_stated)^2. Here s is the clustered standard deviation, s_stated the
/// stated one, and t Student's quantile for the degrees of freedom of s. If the RSS is quadratic, the interval equals
/// Clustered::interval. The call moves the values, so `clustered` and other results computed from them are stale
/// afterwards. Throws [slom.stale-clustered], [slom.no-clustered-deviation] and as above.
ProfileInterval profile(Estimator& est, const VariableHandle& id, const std::string& path,
                        const Clustered& clustered, double probability = 0.95);

}  // namespace slom
