/// Triangular factors of small matrices of fixed size, without allocation and without Eigen's decompositions, which
/// take long to compile.
///   source   Golub and Van Loan, "Matrix computations", 4th edition, 2013: Cholesky 4.2, Householder 5.1
#pragma once

#include <cmath>
#include <limits>

#include <Eigen/Core>

#include "mtk/vectview.hpp"

namespace slom::detail {

template <class S, int R, int C>
using FixedMatrix =
    Eigen::Matrix<S, R, C, (R == 1 && C != 1 ? Eigen::RowMajor : Eigen::ColMajor) | Eigen::DontAlign>;
template <class S, int N>
using SquareMatrix = FixedMatrix<S, N, N>;

template <class S>
bool isFinite(const S& x) {
  return x - x == S(0);
}
template <class D>
bool allFinite(const Eigen::MatrixBase<D>& m) {
  using S = typename D::Scalar;
  const auto difference = [&](Eigen::Index i, Eigen::Index j) {
    return m.derived().coeff(i, j) - m.derived().coeff(i, j);
  };
  S sums[4] = {S(0), S(0), S(0), S(0)};  // independent, so that additions overlap
  const Eigen::Index rows = m.rows(), whole = rows - rows % 4;
  for (Eigen::Index j = 0; j < m.cols(); ++j) {
    for (Eigen::Index i = 0; i < whole; i += 4) {
      for (int k = 0; k < 4; ++k) sums[k] += difference(i + k, j);
    }
    for (Eigen::Index i = whole; i < rows; ++i) sums[i - whole] += difference(i, j);
  }
  return (sums[0] + sums[1]) + (sums[2] + sums[3]) == S(0);
}
/// Returns whether an entry is not 0.
template <class D>
bool hasEntries(const Eigen::MatrixBase<D>& m) {
  using S = typename D::Scalar;
  for (Eigen::Index j = 0; j < m.cols(); ++j) {
    for (Eigen::Index i = 0; i < m.rows(); ++i) {
      if (!(m.derived().coeff(i, j) == S(0))) return true;
    }
  }
  return false;
}

/// Returns A B.
template <class A, class B>
auto product(const Eigen::MatrixBase<A>& a, const Eigen::MatrixBase<B>& b) {
  FixedMatrix<typename A::Scalar, A::RowsAtCompileTime, B::ColsAtCompileTime> result;
  result.noalias() = a.lazyProduct(b);
  return result;
}

/// Returns A^T, without Eigen's check for aliases, which g++ 12 takes for a read of the new matrix.
template <class S, int N>
SquareMatrix<S, N> transposedSquare(const SquareMatrix<S, N>& A) {
  SquareMatrix<S, N> result;
  for (int j = 0; j < N; ++j) {
    for (int i = 0; i < N; ++i) result(i, j) = A(j, i);
  }
  return result;
}
/// Returns A B^T. Zeros of B cost nothing: derivatives of motions and measurements have many.
template <class S, int R, int K, int C>
FixedMatrix<S, R, C> timesTransposed(const FixedMatrix<S, R, K>& A, const FixedMatrix<S, C, K>& B) {
  FixedMatrix<S, R, C> result;
  for (int j = 0; j < C; ++j) {
    mtk::PlainVector<S, R> sum = mtk::PlainVector<S, R>::Zero();
    for (int k = 0; k < K; ++k) {
      const S factor = B(j, k);
      if (factor != S(0)) sum += factor * A.col(k);
    }
    result.col(j) = sum;
  }
  return result;
}

/// Returns whether m equals its transpose up to rounding errors of its largest diagonal entries.
template <int N, class M>
bool isSymmetric(const M& m) {
  using S = typename M::Scalar;
  using std::abs;
  using std::sqrt;
  const S small = sqrt(std::numeric_limits<S>::epsilon()) / S(16);  // products like F Q F^T may cancel
  S size(0);
  for (int i = 0; i < N; ++i) size = abs(m(i, i)) > size ? abs(m(i, i)) : size;
  for (int j = 0; j < N; ++j) {
    for (int i = 0; i < j; ++i) {
      if (m(i, j) == m(j, i)) continue;
      if (!(abs(m(i, j) - m(j, i)) <= small * size)) return false;
    }
  }
  return true;
}
template <int N, class M>
bool isLowerTriangular(const M& m) {
  using S = typename M::Scalar;
  for (int j = 0; j < N; ++j) {
    if (m(j, j) < S(0)) return false;
    for (int i = 0; i < j; ++i) {
      if (m(i, j) != S(0)) return false;
    }
  }
  return allFinite(m);
}
template <int N, class M>
bool hasPositiveDiagonal(const M& m) {
  for (int i = 0; i < N; ++i) {
    if (!(m(i, i) > typename M::Scalar(0))) return false;
  }
  return true;
}

/// Writes lower triangular L with L L^T = A and returns whether A is positive definite. If A is semidefinite, columns
/// without a positive pivot are 0. Reads the lower triangle of A. Zeros of L cost nothing.
template <int N, class S>
bool factorize(const SquareMatrix<S, N>& A, SquareMatrix<S, N>& L) {
  using std::sqrt;
  bool is_definite = true;
  L = A;
  for (int j = 0; j < N; ++j) {
    const S pivot = L(j, j);
    const bool is_positive = pivot > S(4 * N) * std::numeric_limits<S>::epsilon() * A(j, j);
    is_definite = is_definite && is_positive;
    const S root = is_positive ? sqrt(pivot) : S(0);
    for (int i = 0; i < j; ++i) L(i, j) = S(0);
    L(j, j) = root;
    const S inverse = is_positive ? S(1) / root : S(0);
    for (int k = j + 1; k < N; ++k) {
      const S factor = L(k, j) *= inverse;
      if (factor == S(0)) continue;
      L(k, k) -= factor * factor;
      for (int i = k + 1; i < N; ++i) L(i, k) -= L(i, j) * inverse * factor;
    }
  }
  return is_definite;
}

/// Returns whether L L^T is A up to rounding. For the result of factorize: whether A has no negative eigenvalue.
template <int N, class S>
bool isFactorOf(const SquareMatrix<S, N>& L, const SquareMatrix<S, N>& A) {
  using std::abs;
  using std::sqrt;
  // Where the pivot of a matrix without full rank is lost to rounding, entries below it are up to its root.
  const S small = S(8) * sqrt(S(N) * std::numeric_limits<S>::epsilon());
  for (int j = 0; j < N; ++j) {
    for (int i = j; i < N; ++i) {
      S sum(0);
      for (int k = 0; k <= j; ++k) sum += L(i, k) * L(j, k);
      const S size = sqrt(abs(A(i, i))) * sqrt(abs(A(j, j)));
      if (!(abs(sum - A(i, j)) <= small * size)) return false;
    }
  }
  return true;
}

/// Computes b := L^-1 b for lower triangular L.
template <int N, class M, class B>
void solveLower(const M& L, B& b) {
  for (Eigen::Index c = 0; c < b.cols(); ++c) {
    for (int i = 0; i < N; ++i) {
      auto sum = b(i, c);
      for (int k = 0; k < i; ++k) sum -= L(i, k) * b(k, c);
      b(i, c) = sum / L(i, i);
    }
  }
}
/// Computes b := L^-T b.
template <int N, class M, class B>
void solveLowerTransposed(const M& L, B& b) {
  for (Eigen::Index c = 0; c < b.cols(); ++c) {
    for (int i = N - 1; i >= 0; --i) {
      auto sum = b(i, c);
      for (int k = i + 1; k < N; ++k) sum -= L(k, i) * b(k, c);
      b(i, c) = sum / L(i, i);
    }
  }
}
/// Returns L^-1.
template <int N, class S>
SquareMatrix<S, N> inverseLower(const SquareMatrix<S, N>& L) {
  SquareMatrix<S, N> inverse = SquareMatrix<S, N>::Identity();
  solveLower<N>(L, inverse);
  return inverse;
}

/// Makes the Rows x Cols matrix A lower triangular by an orthogonal transformation of its columns: A A^T stays. Needs
/// Cols >= Rows. The diagonal is not negative. Columns beyond Rows are 0 afterwards.
template <int Rows, int Cols, class S>
void makeLowerTriangular(FixedMatrix<S, Rows, Cols>& A) {
  using std::sqrt;
  static_assert(Cols >= Rows);
  S v[std::size_t{Cols}];
  for (int r = 0; r < Rows; ++r) {
    S tail(0);
    for (int c = r + 1; c < Cols; ++c) tail += A(r, c) * A(r, c);
    if (tail == S(0)) {
      if (A(r, r) < S(0)) {
        for (int i = r; i < Rows; ++i) A(i, r) = -A(i, r);
      }
      continue;
    }
    const S length = sqrt(A(r, r) * A(r, r) + tail);
    // The reflection maps the row to +length, with v[r] = A(r, r) - length free of cancellation (Golub 5.1.1).
    v[r] = A(r, r) <= S(0) ? A(r, r) - length : -tail / (A(r, r) + length);
    for (int c = r + 1; c < Cols; ++c) v[c] = A(r, c);
    const S factor = S(2) / (v[r] * v[r] + tail);
    // Column by column, which are contiguous; zeros cost nothing.
    S sums[std::size_t{Rows}];
    for (int i = r + 1; i < Rows; ++i) sums[i] = A(i, r) * v[r];
    for (int c = r + 1; c < Cols; ++c) {
      if (v[c] == S(0)) continue;
      for (int i = r + 1; i < Rows; ++i) sums[i] += A(i, c) * v[c];
    }
    for (int i = r + 1; i < Rows; ++i) sums[i] *= factor;
    for (int c = r; c < Cols; ++c) {
      if (v[c] == S(0)) continue;
      for (int i = r + 1; i < Rows; ++i) A(i, c) -= sums[i] * v[c];
    }
    A(r, r) = length;
    for (int c = r + 1; c < Cols; ++c) A(r, c) = S(0);
  }
}

}  // namespace slom::detail
