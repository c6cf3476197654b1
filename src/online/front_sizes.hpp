/// Operations and memory of a front with p pivots and u further rows.
#pragma once

#include "solve/dense/kernels.hpp"

namespace slom {

inline double flopsOf(double p, double u) { return p * p * p / 3 + p * p * u + p * u * u; }
/// Of vectors that kernels work on.
inline int paddedToStripes(int rows) { return dense::stripesOf(rows) * dense::kStripe; }

}  // namespace slom
