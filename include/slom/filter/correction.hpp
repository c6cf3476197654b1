/// Correction: what an update adds to the mean, and the innovation that it is based on.
#pragma once

#include "slom/filter/square_root.hpp"

namespace slom::detail {

template <class S, int N, int M>
struct Correction {
  mtk::PlainVector<S, N> step;      ///< in the tangent space of the linearisation point
  mtk::PlainVector<S, M> whitened;  ///< L^-1 r, where L L^T is the covariance of the innovation
  S nis = S(0);                     ///< |whitened|^2

  /// Sets the whitened innovation from the lower factor L of its covariance.
  void setWhitened(const SquareMatrix<S, M>& L, const mtk::PlainVector<S, M>& r) {
    whitened = r;
    solveLower<M>(L, whitened);
    nis = whitened.squaredNorm();
  }
};

}  // namespace slom::detail
