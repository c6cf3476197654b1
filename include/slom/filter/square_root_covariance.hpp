/// SquareRootCovariance: the covariance of an error state as L with P = L L^T. It has the precision of twice as many
/// digits, and P never loses positive definiteness.
///   source   Kaminski, Bryson, Schmidt, "Discrete square root filtering: a survey of current techniques", 1971; the
///            array form of the update, Kailath, Sayed, Hassibi, "Linear estimation", 2000, section 12.3
#pragma once

#include "slom/filter/correction.hpp"
#include "slom/filter/noise.hpp"
#include "slom/filter/square_root.hpp"

namespace slom {

template <class S, int N>
class SquareRootCovariance {
 public:
  using Matrix = detail::SquareMatrix<S, N>;

  /// Sets P to the covariance of `noise`.
  template <class Noise>
  void set(const Noise& noise) {
    noise.writeRoot(L_, 0);
  }
  /// Sets P = L L^T for any L.
  void setRoot(const Matrix& L) { L_ = L; }

  /// Returns P.
  Matrix matrix() const { return detail::product(L_, L_.transpose()); }
  /// Returns L with L L^T = P; not triangular in general.
  const Matrix& root() const { return L_; }
  /// Returns whether all numbers are finite.
  bool isFinite() const { return detail::allFinite(L_); }

  /// Predicts: P := F P F^T + the covariances of the terms.
  template <class... Terms>
  void propagate(const Matrix& F, const Terms&... terms) {
    const Matrix upper = detail::transposedSquare<S, N>(L_);  // its zeros cost nothing
    compose(detail::ColumnsNoise<S, N, N>{detail::timesTransposed(F, upper)}, terms...);
  }
  /// Sets P to the sum of the covariances of the terms, which have N or more columns.
  template <class... Terms>
  void compose(const Terms&... terms) {
    constexpr int columns = (Terms::columns + ... + 0);
    detail::FixedMatrix<S, N, columns> A;
    int at = 0;
    const auto append = [&](const auto& term) {
      term.writeRoot(A, at);
      at += std::remove_cvref_t<decltype(term)>::columns;
    };
    (append(terms), ...);
    detail::makeLowerTriangular<N, columns>(A);
    L_ = A.template leftCols<N>();
  }

  /// Updates as FullCovariance::correct does, by one orthogonal transformation of
  ///   [root of R   H L]      [root of S        0]
  ///   [     0        L]  to  [gain times it  new L].
  template <int M, class Noise>
  bool correct(const detail::FixedMatrix<S, M, N>& H, const mtk::PlainVector<S, M>& r, const Noise& noise,
               const S& factor, detail::Correction<S, N, M>& correction) {
    return correctWhitened<M, M>(
        detail::product(H, L_), r, [&](auto& A) { noise.writeRoot(A, 0, factor); }, correction);
  }

  /// Updates with a residual r + A u + e, where x = L u. `write_noise` writes a root of e's covariance to the first Q
  /// columns of a matrix.
  template <int M, int Q, class WriteNoise>
  bool correctWhitened(const detail::FixedMatrix<S, M, N>& HL, const mtk::PlainVector<S, M>& r,
                       const WriteNoise& write_noise, detail::Correction<S, N, M>& correction) {
    detail::FixedMatrix<S, M + N, Q + N> A;
    write_noise(A);
    A.template bottomLeftCorner<N, Q>().setZero();
    A.template topRightCorner<M, N>() = HL;
    A.template bottomRightCorner<N, N>() = L_;
    detail::makeLowerTriangular<M + N, Q + N>(A);
    const detail::SquareMatrix<S, M> root = A.template topLeftCorner<M, M>();
    S largest(0);
    for (int i = 0; i < M; ++i) largest = root(i, i) > largest ? root(i, i) : largest;
    if (!detail::hasPositiveDiagonal<M>(root) || !detail::isFinite(largest)) return false;
    correction.setWhitened(root, r);
    correction.step.noalias() = -(A.template bottomLeftCorner<N, M>().lazyProduct(correction.whitened));
    L_ = A.template block<N, N>(M, M);
    return true;
  }

  /// Replaces the components at, at + 1, ... of the error by J times themselves.
  template <int K>
  void transform(int at, const detail::SquareMatrix<S, K>& J) {
    const detail::FixedMatrix<S, K, N> rows = detail::product(J, L_.template middleRows<K>(at));
    L_.template middleRows<K>(at) = rows;
  }

 private:
  Matrix L_;
};

}  // namespace slom
