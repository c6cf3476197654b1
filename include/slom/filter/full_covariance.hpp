/// FullCovariance: the covariance of an error state as a matrix P, with the Kalman filter's equations.
///   source   Kalman, "A new approach to linear filtering and prediction problems", 1960; the update in Joseph's form,
///            Bucy and Joseph, "Filtering for stochastic processes", 1968
#pragma once

#include "slom/filter/correction.hpp"
#include "slom/filter/square_root.hpp"

namespace slom {

template <class S, int N>
class FullCovariance {
 public:
  using Matrix = detail::SquareMatrix<S, N>;

  /// Sets P to the covariance of `noise`.
  template <class Noise>
  void set(const Noise& noise) {
    P_.setZero();
    noise.addTo(P_);
  }
  /// Sets P = L L^T.
  void setRoot(const Matrix& L) { P_ = detail::product(L, L.transpose()); }

  /// Returns P.
  const Matrix& matrix() const { return P_; }
  /// Returns lower triangular L with L L^T = P.
  Matrix root() const {
    Matrix L;
    detail::factorize<N>(P_, L);
    return L;
  }
  /// Returns whether all variances are finite; then the covariances are, too.
  bool isFinite() const { return detail::allFinite(P_.diagonal()); }

  /// Predicts: P := F P F^T + the covariances of the terms.
  template <class... Terms>
  void propagate(const Matrix& F, const Terms&... terms) {
    const Matrix FP = detail::transposedSquare<S, N>(detail::timesTransposed(P_, F));  // P is symmetric
    P_ = detail::timesTransposed(FP, F);
    (terms.addTo(P_), ...);
    symmetrize();
  }

  /// Sets P to the sum of the covariances of the terms.
  template <class... Terms>
  void compose(const Terms&... terms) {
    P_.setZero();
    (terms.addTo(P_), ...);
    symmetrize();
  }

  /// Updates with a residual r + H x of covariance R = factor * noise: x ~ N(0, P) becomes correction.step + N(0, new
  /// P). If the covariance of the innovation is not positive definite, returns false and leaves P unchanged.
  template <int M, class Noise>
  bool correct(const detail::FixedMatrix<S, M, N>& H, const mtk::PlainVector<S, M>& r, const Noise& noise,
               const S& factor, detail::Correction<S, N, M>& correction) {
    const detail::FixedMatrix<S, N, M> PHt = detail::timesTransposed(P_, H);
    detail::SquareMatrix<S, M> innovation = detail::product(H, PHt), L;
    noise.addTo(innovation, factor);
    if (!detail::factorize<M>(innovation, L)) return false;
    detail::FixedMatrix<S, M, N> gain = PHt.transpose();  // K^T = S^-1 H P
    detail::solveLower<M>(L, gain);
    detail::solveLowerTransposed<M>(L, gain);
    correction.setWhitened(L, r);
    correction.step.noalias() = -(gain.transpose().lazyProduct(r));
    // (I - K H) P (I - K H)^T + K R K^T, from T = (I - K H) P: T - (T H^T - K R) K^T.
    P_.noalias() -= gain.transpose().lazyProduct(PHt.transpose());
    detail::FixedMatrix<S, N, M> rest = detail::timesTransposed(P_, H);
    detail::SquareMatrix<S, M> R = detail::SquareMatrix<S, M>::Zero();
    noise.addTo(R, factor);
    rest.noalias() -= gain.transpose().lazyProduct(R);
    P_.noalias() -= rest.lazyProduct(gain);
    symmetrize();
    return true;
  }

  /// Replaces the components at, at + 1, ... of the error by J times themselves.
  template <int K>
  void transform(int at, const detail::SquareMatrix<S, K>& J) {
    const detail::FixedMatrix<S, K, N> rows = detail::product(J, P_.template middleRows<K>(at));
    const detail::SquareMatrix<S, K> block = detail::product(rows.template middleCols<K>(at), J.transpose());
    P_.template middleRows<K>(at) = rows;
    P_.template middleCols<K>(at) = rows.transpose();
    P_.template block<K, K>(at, at) = (block + block.transpose()) / S(2);
  }

 private:
  void symmetrize() {
    for (int j = 0; j < N; ++j) {
      for (int i = 0; i < j; ++i) P_(i, j) = P_(j, i) = (P_(i, j) + P_(j, i)) / S(2);
    }
  }

  Matrix P_;
};

}  // namespace slom
