// Vectors of four numbers, and small blocks in them.
#include <cstddef>

#include "kernels.hpp"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wpsabi"  // how vectors are passed does not matter: nothing of it leaves this source
#endif

namespace slom::dense {
namespace {

constexpr int smaller(int a, int b) { return a < b ? a : b; }

constexpr int kLanes = 4;
typedef double Vector __attribute__((vector_size(kLanes * sizeof(double)), aligned(alignof(double)), may_alias));

inline __attribute__((always_inline)) Vector load(const double* p) { return *reinterpret_cast<const Vector*>(p); }
inline __attribute__((always_inline)) void store(double* p, Vector x) { *reinterpret_cast<Vector*>(p) = x; }
inline __attribute__((always_inline)) Vector all(double x) { return Vector{x, x, x, x}; }

/// The sum of each vector's lanes.
inline __attribute__((always_inline)) Vector sums(Vector a, Vector b, Vector c, Vector d) {
  const Vector ab = __builtin_shufflevector(a, b, 0, 4, 2, 6) + __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Vector cd = __builtin_shufflevector(c, d, 0, 4, 2, 6) + __builtin_shufflevector(c, d, 1, 5, 3, 7);
  return __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
}

constexpr int padded(int k) { return (k + kRowPadding - 1) / kRowPadding * kRowPadding; }
static_assert(kRowPadding == kLanes);

/// The K rows of a column as vectors, 0 behind the last.
template <int K>
inline __attribute__((always_inline)) void loadColumn(const double* column, Vector (&x)[padded(K) / kLanes]) {
#pragma GCC unroll 4
  for (int v = 0; v < K / kLanes; ++v) x[v] = load(column + kLanes * v);
  if constexpr (K % kLanes != 0) {
    Vector last = all(0);
    for (int i = K / kLanes * kLanes; i < K; ++i) last[i % kLanes] = column[i];
    x[K / kLanes] = last;
  }
}

template <int K>
inline __attribute__((always_inline)) void storeColumn(double* column, const Vector (&x)[padded(K) / kLanes]) {
  constexpr int kWhole = K / kLanes;
#pragma GCC unroll 4
  for (int v = 0; v < kWhole; ++v) store(column + kLanes * v, x[v]);
  for (int i = K / kLanes * kLanes; i < K; ++i) column[i] = x[i / kLanes][i % kLanes];
}

/// Entries [4 V, 4 V + 4) of a 3 x 3 block y z^T, column-major, need these of y and of z.
template <int V>
inline __attribute__((always_inline)) Vector rowsOfThree(Vector y) {
  return __builtin_shufflevector(y, y, 4 * V % 3, (4 * V + 1) % 3, (4 * V + 2) % 3, (4 * V + 3) % 3);
}
template <int V>
inline __attribute__((always_inline)) Vector columnsOfThree(Vector z) {
  return __builtin_shufflevector(z, z, 4 * V / 3, (4 * V + 1) / 3, (4 * V + 2) / 3, (4 * V + 3) / 3);
}

/// Vectors y and z of 3 numbers as they are needed in outer products, y as the left factor and z as the right one; their
/// fourth lanes may be anything.
struct Three {
  Vector rows[2], columns[2];
  double last_row, last_column;
  Three() = default;
  Three(Vector y, Vector z)
      : rows{rowsOfThree<0>(y), rowsOfThree<1>(y)},
        columns{columnsOfThree<0>(z), columnsOfThree<1>(z)},
        last_row(y[2]),
        last_column(z[2]) {}
};

/// A block of 3 x 3, column-major.
struct ThreeByThree {
  Vector first, second;
  double last;
  explicit ThreeByThree(const double* p) : first(load(p)), second(load(p + 4)), last(p[8]) {}
  void add(const Three& y, const Three& z) {
    first += y.rows[0] * z.columns[0];
    second += y.rows[1] * z.columns[1];
    last += y.last_row * z.last_column;
  }
  void subtract(const Three& y, const Three& z) {
    first -= y.rows[0] * z.columns[0];
    second -= y.rows[1] * z.columns[1];
    last -= y.last_row * z.last_column;
  }
  void storeTo(double* p) const {
    store(p, first);
    store(p + 4, second);
    p[8] = last;
  }
};

/// The columns of a 3 x 3 matrix, with any number in the fourth lane.
inline __attribute__((always_inline)) void columnsOf(const double* A, Vector (&columns)[3]) {
  columns[0] = load(A);
  columns[1] = load(A + 3);
  const Vector last = load(A + 5);
  columns[2] = __builtin_shufflevector(last, last, 1, 2, 3, 3);
}
inline __attribute__((always_inline)) void rowsOf(const double* A, Vector (&rows)[3]) {
  Vector c[3];
  columnsOf(A, c);
  const Vector low = __builtin_shufflevector(c[0], c[1], 0, 4, 1, 5), high = __builtin_shufflevector(c[0], c[1], 2, 6, 2, 6);
  rows[0] = __builtin_shufflevector(low, c[2], 0, 1, 4, 4);
  rows[1] = __builtin_shufflevector(low, c[2], 2, 3, 5, 5);
  rows[2] = __builtin_shufflevector(high, c[2], 0, 1, 6, 6);
}

}  // namespace
}  // namespace slom::dense
