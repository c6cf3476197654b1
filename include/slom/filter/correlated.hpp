/// Biases that are correlated in time: first-order Gauss-Markov processes, dx/dt = -x / tau + w.
///   source   Brown and Hwang, "Introduction to random signals and applied Kalman filtering", 4th edition, 2012, section 4.2
#pragma once

#include <cmath>

#include "mtk/detail/cpp20.hpp"

namespace slom::filter {

/// Returns the factor by which such a bias decays in `duration` [s]: x' = factor x + noise.
template <class S>
S correlation(const S& tau, const S& duration) {
  using std::exp;
  return exp(-duration / tau);
}
/// Returns the variance of the noise in `duration` [s], for the stationary standard deviation sigma.
template <class S>
S correlatedVariance(const S& sigma, const S& tau, const S& duration) {
  using std::expm1;
  return -sigma * sigma * expm1(S(-2) * duration / tau);
}

}  // namespace slom::filter
