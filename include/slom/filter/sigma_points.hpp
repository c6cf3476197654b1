/// Sigma points: mean and covariance of a function of a state with noise, without derivatives.
///
/// For x ~ mu [+] N(0, L L^T), n columns L_i and the spread s, the points are mu and mu [+] (+-s L_i).
///   mean          weights 1 / (2 s^2), and 1 - n / s^2 for the first, on the manifold
///   first order   D_i = (y_i+ - y_i-) / (2 s): the covariance of y and x is D L^T
///   second order  E_i = sqrt(s^2 - 1) / (2 s^2) (y_i+ + y_i- - 2 y_0)
///   covariance    D D^T + E E^T, without a negative weight for any n; differences y are in the tangent space of the mean
/// s = sqrt(3) has the fourth moment of a normal distribution. s = 1 has the points of Hertzberg et al.
///   source   Julier and Uhlmann, "A new extension of the Kalman filter to nonlinear systems", 1997; on manifolds Hertzberg
///            et al. 2013, section 3.5, and Brossard, Barrau, Bonnabel, "A code for unscented Kalman filtering on manifolds",
///            2020; the second-order term Norgaard, Poulsen, Ravn, "New developments in state estimation for nonlinear
///            systems", 2000, equation 70
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "mtk/manifold.hpp"
#include "slom/filter/square_root.hpp"

namespace slom::detail {

/// One point: the column of L and the direction along it; sign 0 is the mean.
struct SigmaPoint {
  int column = 0, sign = 0;
};

/// Values of a function at the sigma points: y[0], then y_1+, y_1-, y_2+, ...
template <class Y, int Columns>
using SigmaValues = std::array<Y, std::size_t{2 * Columns + 1}>;

/// Weights of the points for n columns.
template <class S, int Columns>
struct SigmaWeights {
  S outer, center, first, second;
  explicit SigmaWeights(const S& spread) {
    using std::sqrt;
    const S square = spread * spread;
    outer = S(1) / (S(2) * square);
    center = S(1) - S(Columns) / square;
    first = S(1) / (S(2) * spread);
    second = sqrt(square > S(1) ? square - S(1) : S(0)) / (S(2) * square);
  }
};

/// First- and second-order columns of a vector that depends on the columns of L.
template <class S, int Rows, int Columns>
struct SigmaColumns {
  FixedMatrix<S, Rows, Columns> first, second;

  /// Sets the columns from differences to one point: at(k) is that of value k.
  template <class At>
  void set(const SigmaWeights<S, Columns>& weights, const At& at) {
    const mtk::PlainVector<S, Rows> center = at(0);
    for (int i = 0; i < Columns; ++i) {
      const mtk::PlainVector<S, Rows> plus = at(2 * i + 1), minus = at(2 * i + 2);
      first.col(i) = weights.first * (plus - minus);
      second.col(i) = weights.second * (plus + minus - S(2) * center);
    }
  }
};

/// Writes the mean of values on a manifold: where the weighted differences sum to 0. Returns false if the iteration
/// does not settle.
template <class Y, int Columns>
bool sigmaMean(const SigmaValues<Y, Columns>& values, const SigmaWeights<mtk::scalar_t<Y>, Columns>& weights,
               Y& mean) {
  using S = mtk::scalar_t<Y>;
  mean = values[0];
  mtk::tangent_t<Y> sizes;
  mtk::typicalSizes<Y>(sizes, mean);
  S last = std::numeric_limits<S>::max();
  for (int iteration = 0; iteration < 50; ++iteration) {
    mtk::tangent_t<Y> step = weights.center * mtk::difference(values[0], mean);
    for (std::size_t k = 1; k < values.size(); ++k) step += weights.outer * mtk::difference(values[k], mean);
    if (!allFinite(step)) return false;
    mtk::boxplus<Y>(mean, step);
    S change(0);
    for (int i = 0; i < mtk::DOF_v<Y>; ++i) {
      const S size = step[i] * step[i] / ((S(1) + sizes[i]) * (S(1) + sizes[i]));
      change = size > change ? size : change;
    }
    // Settled, or at the limit of rounding errors.
    const S small = S(16) * std::numeric_limits<S>::epsilon();
    if (change <= small * small || (change >= last && change <= S(1e6) * small * small)) return true;
    last = change;
  }
  return false;
}

}  // namespace slom::detail
