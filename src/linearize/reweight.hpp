/// Losses in the normal equations. Each measurement's whitened residual r and Jacobian J become r~ and J~ with
///
///     r~ = sqrt(rho'/D) r      J~ = sqrt(rho') (I - k r r^T) J
///     D = 1 + 2 s rho''/rho'   k = (1 - sqrt(D)) / s   s = |r|^2
///
/// So J~^T r~ = rho' J^T r is exactly half the gradient of rho(s). J~^T J~ = J^T (rho' I + 2 rho'' r r^T) J is half its
/// Hessian, without the second derivatives of r, as in least squares.
///
/// For D < 1/4, the loss is concave or nearly concave along r. The model would have little or no curvature, and the
/// step would be too long. Then k = 0 and D = 1: plain reweighting. Because rho is concave, that model is never below
/// the cost of a linear r. This applies to Huber's tails (D = 0) and to outliers of other losses: t = s / c^2 above 3
/// for pseudo-Huber, 3/5 for Cauchy, 3/13 for Geman-McClure, 3/19 for Tukey.
///   source   Triggs, McLauchlan, Hartley and Fitzgibbon, "Bundle adjustment - a modern synthesis", 2000, section 4.3
///            (alpha there is k s)
#pragma once

#include "slom/problem/problem.hpp"

namespace slom {

/// Returns sum rho(s) over the measurements [first, last) of `pool`. r holds their whitened residuals, stacked. If one
/// is not finite, returns NaN, even if the loss is bounded.
double robustCost(const MeasurementPool& pool, int first, int last, double graduation, const double* r);

/// Returns robustCost(), and scales r and J (as in JacobianBatch) in place.
double reweight(const Problem& problem, const MeasurementPool& pool, int first, int last, double graduation,
                double* r, double* J);

/// Returns max s / c^2 over those measurements that have a loss of scale c; -1 if none has a loss.
double largestLossArgument(const MeasurementPool& pool, int first, int last, const double* r);

}  // namespace slom
