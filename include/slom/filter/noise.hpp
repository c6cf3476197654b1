/// Stated noise as filters use it: a covariance of fixed size, its square root, and whether it is valid.
///
/// For each form of slom/model/noise.hpp, with a number or a vector the noise is diagonal. A matrix of fixed or
/// run-time size is a full one. Numbers are converted to the scalar of the filter.
#pragma once

#include <cmath>
#include <type_traits>

#include "mtk/vectview.hpp"
#include "slom/filter/square_root.hpp"
#include "slom/model/noise.hpp"

namespace slom::detail {

/// Independent components: n variances.
template <class S, int N>
struct DiagonalNoise {
  static constexpr int columns = N;  ///< of a root
  mtk::PlainVector<S, N> variances;

  /// Returns whether all variances are finite and >= 0; if `positive`, > 0.
  bool isValid(bool positive) const {
    for (int i = 0; i < N; ++i) {
      if (!(positive ? variances[i] > S(0) : variances[i] >= S(0)) || !isFinite(variances[i])) return false;
    }
    return true;
  }
  /// Adds the covariance, times `factor`, to the N x N block of P that begins at row and column `at`.
  template <class M>
  void addTo(M& P, const S& factor = S(1), int at = 0) const {
    for (int i = 0; i < N; ++i) P(at + i, at + i) += factor * variances[i];
  }
  /// Writes L with L L^T = covariance to columns `column` ... of A.
  template <class M>
  void writeRoot(M& A, int column, const S& factor = S(1)) const {
    using std::sqrt;
    for (int j = 0; j < N; ++j) {
      for (int i = 0; i < N; ++i) A(i, column + j) = S(0);
      A(j, column + j) = sqrt(factor * variances[j]);
    }
  }
  /// Computes v := Sigma^-1 v, and returns v^T Sigma^-1 v.
  S squaredLength(const mtk::PlainVector<S, N>& v) const {
    S sum(0);
    for (int i = 0; i < N; ++i) sum += v[i] * v[i] / variances[i];
    return sum;
  }
};

/// Correlated components: Sigma = L L^T.
template <class S, int N>
struct FullNoise {
  static constexpr int columns = N;
  SquareMatrix<S, N> covariance;
  SquareMatrix<S, N> root;
  bool is_given = false, is_definite = false;

  bool isValid(bool positive) const { return is_given && (is_definite || !positive); }
  template <class M>
  void addTo(M& P, const S& factor = S(1), int at = 0) const {
    for (int j = 0; j < N; ++j) {
      for (int i = 0; i < N; ++i) P(at + i, at + j) += factor * covariance(i, j);
    }
  }
  template <class M>
  void writeRoot(M& A, int column, const S& factor = S(1)) const {
    using std::sqrt;
    const S f = sqrt(factor);
    for (int j = 0; j < N; ++j) {
      for (int i = 0; i < N; ++i) A(i, column + j) = f * root(i, j);
    }
  }
  S squaredLength(mtk::PlainVector<S, N> v) const {
    solveLower<N>(root, v);
    return v.squaredNorm();
  }
};

/// The noise factor * G w, for noise w of Q components.
template <class S, int N, int Q, class Noise>
struct MappedNoise {
  static constexpr int columns = Q;
  FixedMatrix<S, N, Q> G;
  Noise noise;
  S factor = S(1);  ///< of the covariance

  template <class M>
  void addTo(M& P) const {
    SquareMatrix<S, Q> covariance = SquareMatrix<S, Q>::Zero();
    noise.addTo(covariance, factor);
    P.noalias() += product(G, covariance).lazyProduct(G.transpose());
  }
  template <class M>
  void writeRoot(M& A, int column) const {
    SquareMatrix<S, Q> root;
    noise.writeRoot(root, 0, factor);
    A.template block<N, Q>(0, column).noalias() = G.lazyProduct(root);
  }
};

/// Noise by a root of its covariance, with K columns.
template <class S, int N, int K>
struct ColumnsNoise {
  static constexpr int columns = K;
  FixedMatrix<S, N, K> root;

  template <class M>
  void addTo(M& P) const {
    P.noalias() += root.lazyProduct(root.transpose());
  }
  template <class M>
  void writeRoot(M& A, int column) const {
    for (int j = 0; j < K; ++j) {
      for (int i = 0; i < N; ++i) A(i, column + j) = root(i, j);
    }
  }
};

/// Returns the diagonal noise of a number or a vector in the form F.
template <NoiseForm F, class S, int N, class T>
DiagonalNoise<S, N> diagonalNoise(const T& stated) {
  DiagonalNoise<S, N> noise;
  for (int i = 0; i < N; ++i) {
    const S x = [&] {
      if constexpr (std::is_arithmetic_v<T>) {
        return S(stated);
      } else {
        return stated.size() == N ? S(stated[i]) : S(-1);
      }
    }();
    const bool is_deviation = F == NoiseForm::standard_deviation || F == NoiseForm::inv_standard_deviation;
    const S square = is_deviation ? (x < S(0) ? S(-1) : x * x) : x;
    const bool is_inverse = F == NoiseForm::inv_covariance || F == NoiseForm::inv_standard_deviation;
    noise.variances[i] = is_inverse ? S(1) / square : square;
  }
  return noise;
}

/// Sets the noise to a matrix in the form F. If the matrix is not valid, `is_given` stays false.
template <NoiseForm F, class S, int N, class T>
void setFullNoise(const T& stated, FullNoise<S, N>& noise) {
  if (stated.rows() != N || stated.cols() != N) return;
  const bool is_root = F == NoiseForm::standard_deviation || F == NoiseForm::inv_standard_deviation;
  SquareMatrix<S, N>& given = is_root ? noise.root : noise.covariance;
  for (int j = 0; j < N; ++j) {
    for (int i = 0; i < N; ++i) given(i, j) = S(stated(i, j));
  }
  if (is_root ? !isLowerTriangular<N>(given) : !isSymmetric<N>(given)) return;
  if constexpr (is_root) {
    noise.is_definite = hasPositiveDiagonal<N>(given);
  } else {
    noise.is_definite = factorize<N>(given, noise.root);
    // A number that is not finite makes a pivot that is not positive.
    if (!noise.is_definite && !(allFinite(given) && isFactorOf<N>(noise.root, given))) return;
  }
  if constexpr (F == NoiseForm::inv_covariance || F == NoiseForm::inv_standard_deviation) {
    if (!noise.is_definite) return;
    noise.root = inverseLower<N>(noise.root);
    if constexpr (F == NoiseForm::inv_covariance) {  // Sigma = W^T W, and its factor again
      noise.covariance = product(noise.root.transpose(), noise.root);
      noise.is_definite = factorize<N>(noise.covariance, noise.root);
      noise.is_given = noise.is_definite;
      return;
    }
  }
  if constexpr (is_root) noise.covariance = product(noise.root, noise.root.transpose());
  noise.is_given = true;
}

/// Returns the noise of N components as filters use it.
template <class S, int N, NoiseForm F, class T>
auto resolvedNoise(const Noise<F, T>& stated) {
  if constexpr (std::is_arithmetic_v<T>) {
    return diagonalNoise<F, S, N>(stated.value);
  } else {
    constexpr int rows = T::RowsAtCompileTime, cols = T::ColsAtCompileTime;
    static_assert(std::is_convertible_v<typename T::Scalar, S>,
                  "slom: the noise must consist of real numbers");
    if constexpr (bool(T::IsVectorAtCompileTime) && !(rows == 1 && cols == 1 && N == 1)) {
      static_assert(T::SizeAtCompileTime == mtk::Dynamic || int(T::SizeAtCompileTime) == N,
                    "slom: the vector of the noise must have one number for each component");
      return diagonalNoise<F, S, N>(stated.value);
    } else {
      static_assert((rows == mtk::Dynamic || rows == N) && (cols == mtk::Dynamic || cols == N),
                    "slom: the matrix of the noise must have one row and one column for each component");
      FullNoise<S, N> noise;
      setFullNoise<F>(stated.value, noise);
      return noise;
    }
  }
}

}  // namespace slom::detail
