/// How losses enter the normal equations: each measurement's whitened residual r and Jacobian J become r~ and J~ with
///
///     r~ = sqrt(rho'/D) r      J~ = sqrt(rho') (I - k r r^T) J
///     D = 1 + 2 s rho''/rho'   k = (1 - sqrt(D)) / s   s = |r|^2
///
/// so that J~^T r~ = rho' J^T r is half the gradient of rho(s) exactly, and J~^T J~ = J^T (rho' I + 2 rho'' r r^T) J is
/// half its Hessian but for the second derivatives of r, as in least squares.
/// For D < 1/4, where the loss is nearly or truly concave along r, the model would have little or no curvature and the
/// step would be too long; there k = 0 and D = 1 are taken: plain reweighting. As rho is concave, that model is never
/// below the cost of a linear r. So it is for Huber's tails (D = 0) and for outliers of the others, t = s / c^2 above 3
/// of pseudo-Huber, 3/5 of Cauchy, 3/13 of Geman-McClure, 3/19 of Tukey.
///   source   Triggs, McLauchlan, Hartley and Fitzgibbon, "Bundle adjustment - a modern synthesis", 2000, section 4.3
///            (alpha there is k s)
#pragma once

#include "slom/problem/problem.hpp"

namespace slom {

/// sum rho(s) over the measurements [first, last) of `pool`; r: their whitened residuals one after the other. NaN when
/// one is not finite, also where the loss is bounded.
double robustCost(const MeasurementPool& pool, int first, int last, double graduation, const double* r);

/// The same, and scales r and J (as in JacobianBatch) in place.
double reweight(const Problem& problem, const MeasurementPool& pool, int first, int last, double graduation,
                double* r, double* J);

/// max s / c^2 over those of them that have a loss of scale c; -1 when none has.
double largestLossArgument(const MeasurementPool& pool, int first, int last, const double* r);

}  // namespace slom
