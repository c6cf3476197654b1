/// A front's part of the inverse, computed from its part of the factor and its parent's part of the inverse.
#pragma once

#include <Eigen/Core>

namespace slom {

/// Completes Z, (p + u) x (p + u), pivots first. Its block of the u other rows is given. D, B: the front's panels
/// (solve/dense/kernels.hpp).
///   source   Takahashi, Fagan and Chen, "Formation of a sparse bus impedance matrix and its application to short
///            circuit study", 1973; Campbell and Davis, "Computing the sparse inverse subset: an inverse multifrontal
///            approach", 1995
void invertFront(const double* D, const double* B, int p, int u, Eigen::MatrixXd& Z);

}  // namespace slom
