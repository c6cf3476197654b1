/// A front's part of the inverse, from its part of the factor and that of its parent.
#pragma once

#include <Eigen/Core>

namespace slom {

/// Z: (p + u) x (p + u), pivots first, whose block of the u other rows is given; the rest is computed. D, B: the front's panels
/// (solve/dense/kernels.hpp).
///   source   Takahashi, Fagan and Chen, "Formation of a sparse bus impedance matrix and its application to short circuit
///            study", 1973; Campbell and Davis, "Computing the sparse inverse subset: an inverse multifrontal approach", 1995
void invertFront(const double* D, const double* B, int p, int u, Eigen::MatrixXd& Z);

}  // namespace slom
