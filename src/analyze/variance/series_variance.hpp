/// Variance of the sum of a series with correlated neighbours.
#pragma once

#include <Eigen/Core>

namespace slom {

struct SeriesVariance {
  double correlation = 0;  ///< rho of successive numbers, 0 to 0.95
  double factor = 1;       ///< variance of the sum over that of independent numbers of the same size
  double dof = 0;          ///< degrees of freedom of the estimate
};

/// Estimates the variance from an autoregressive series of first order with its mean subtracted. A fit subtracts the
/// mean from the contributions of groups in the same way, which lowers the observed correlation. The estimate is the
/// rho whose expected observed correlation is the observed one. For few numbers this is better than blocks.
///   source   Andrews and Monahan, "An improved heteroskedasticity and autocorrelation consistent covariance matrix
///            estimator", 1992, for the autoregression; Kendall, "Note on bias in the estimation of autocorrelation",
///            1954, for the bias
SeriesVariance seriesVariance(const Eigen::VectorXd& series);

}  // namespace slom
