/// The variance of the sum of a series whose successive numbers are alike.
#pragma once

#include <Eigen/Core>

namespace slom {

struct SeriesVariance {
  double correlation = 0;  ///< rho of successive numbers, 0 to 0.95
  double factor = 1;       ///< variance of the sum over that of independent numbers of the same size
  double dof = 0;          ///< degrees of freedom of the estimate
};

/// Of an autoregressive series of first order whose mean has been taken out, as a fit takes it out of the contributions of groups: rho is the one
/// of which the observed correlation, too small by that, is the mean. Better than blocks where there are few numbers.
///   source   Andrews and Monahan, "An improved heteroskedasticity and autocorrelation consistent covariance matrix estimator", 1992, for the
///            autoregression; Kendall, "Note on bias in the estimation of autocorrelation", 1954, for the bias
SeriesVariance seriesVariance(const Eigen::VectorXd& series);

}  // namespace slom
