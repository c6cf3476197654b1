// Vectors of four numbers, columns made of them, and small blocks.
#include <cstddef>
#include <type_traits>

#include "kernels.hpp"

#if defined(__FMA__)
#include <immintrin.h>
#endif

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wpsabi"  // how vectors are passed does not matter: nothing of it leaves this source
#endif

/// Whatever the instruction set, none of this is called.
#define SLOM_INLINE __attribute__((always_inline))

namespace slom::dense {
namespace {

constexpr int smaller(int a, int b) { return a < b ? a : b; }

constexpr int kLanes = 4;
typedef double Vector __attribute__((vector_size(kLanes * sizeof(double))));
typedef Vector VectorInMemory __attribute__((aligned(alignof(double)), may_alias));

SLOM_INLINE inline Vector load(const double* p) { return *reinterpret_cast<const VectorInMemory*>(p); }
SLOM_INLINE inline void store(double* p, Vector x) { *reinterpret_cast<VectorInMemory*>(p) = x; }
SLOM_INLINE inline Vector all(double x) { return Vector{x, x, x, x}; }

// Multiply-adds are written as such, and the kernels are compiled without contraction: then no compiler and no choice of registers changes
// the bits.

/// x + a b and x - a b, rounded once where the processor can; for numbers and vectors.
SLOM_INLINE inline double plusProduct(double x, double a, double b) {
#if defined(__FMA__)
  return __builtin_fma(a, b, x);
#else
  return x + a * b;
#endif
}
SLOM_INLINE inline double minusProduct(double x, double a, double b) {
#if defined(__FMA__)
  return __builtin_fma(-a, b, x);
#else
  return x - a * b;
#endif
}
SLOM_INLINE inline Vector plusProduct(Vector x, Vector a, Vector b) {
#if defined(__FMA__)
  return (Vector)_mm256_fmadd_pd((__m256d)a, (__m256d)b, (__m256d)x);
#else
  return x + a * b;
#endif
}
SLOM_INLINE inline Vector minusProduct(Vector x, Vector a, Vector b) {
#if defined(__FMA__)
  return (Vector)_mm256_fnmadd_pd((__m256d)a, (__m256d)b, (__m256d)x);
#else
  return x - a * b;
#endif
}

/// The sum of each vector's lanes.
SLOM_INLINE inline Vector sums(Vector a, Vector b, Vector c, Vector d) {
  const Vector ab = __builtin_shufflevector(a, b, 0, 4, 2, 6) + __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Vector cd = __builtin_shufflevector(c, d, 0, 4, 2, 6) + __builtin_shufflevector(c, d, 1, 5, 3, 7);
  return __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
}

constexpr int padded(int k) { return (k + kRowPadding - 1) / kRowPadding * kRowPadding; }
static_assert(kRowPadding == kLanes);

/// The first `count` of four numbers, padded with 0; count is known to the compiler.
SLOM_INLINE inline Vector loadSome(const double* p, int count) {
  if (count == kLanes) return load(p);
  Vector x = all(0);
  for (int i = 0; i < count; ++i) x[i] = p[i];
  return x;
}
SLOM_INLINE inline void storeSome(double* p, Vector x, int count) {
  if (count == kLanes) return store(p, x);
  for (int i = 0; i < count; ++i) p[i] = x[i];
}

// Columns of 4 H numbers in registers. With AVX-512 two vectors of four are one of eight; each number is computed in the
// same way, so that results have the same bits as with AVX2.
#if defined(__AVX512F__)
typedef double Wide __attribute__((vector_size(8 * sizeof(double))));
typedef Wide WideInMemory __attribute__((aligned(alignof(double)), may_alias));
SLOM_INLINE inline Wide loadWide(const double* p) { return *reinterpret_cast<const WideInMemory*>(p); }
SLOM_INLINE inline void storeWide(double* p, Wide x) { *reinterpret_cast<WideInMemory*>(p) = x; }
SLOM_INLINE inline Wide allWide(double x) { return Wide{x, x, x, x, x, x, x, x}; }
SLOM_INLINE inline Wide plusProduct(Wide x, Wide a, Wide b) {
  return (Wide)_mm512_fmadd_pd((__m512d)a, (__m512d)b, (__m512d)x);
}
SLOM_INLINE inline Wide minusProduct(Wide x, Wide a, Wide b) {
  return (Wide)_mm512_fnmadd_pd((__m512d)a, (__m512d)b, (__m512d)x);
}
SLOM_INLINE inline Vector lower(Wide x) { return __builtin_shufflevector(x, x, 0, 1, 2, 3); }
SLOM_INLINE inline Vector upper(Wide x) { return __builtin_shufflevector(x, x, 4, 5, 6, 7); }

/// The same number in all lanes.
struct Factor {
  Wide wide;
  Vector narrow;
  SLOM_INLINE explicit Factor(double x) : wide(allWide(x)), narrow(lower(wide)) {}
};
template <int H>
struct Column {
  static constexpr int kWide = H / 2;
  Wide wide[kWide > 0 ? kWide : 1];
  Vector narrow;  // when H is odd

  SLOM_INLINE static Column zero() {
    Column x;
    for (Wide& w : x.wide) w = allWide(0);
    x.narrow = all(0);
    return x;
  }
  /// `rows` numbers, more than 4 (H - 1), padded with 0.
  SLOM_INLINE static Column loaded(const double* p, int rows = 4 * H) {
    Column x = {};
#pragma GCC unroll 4
    for (int i = 0; i < kWide; ++i) {
      if (8 * i + 8 <= rows) {
        x.wide[i] = loadWide(p + 8 * i);
      } else {
        x.wide[i] = __builtin_shufflevector(load(p + 8 * i), loadSome(p + 8 * i + 4, rows - 8 * i - 4), 0, 1, 2, 3, 4, 5, 6, 7);
      }
    }
    if constexpr (H % 2 != 0) x.narrow = loadSome(p + 8 * kWide, rows - 8 * kWide);
    return x;
  }
  SLOM_INLINE void storeTo(double* p, int rows = 4 * H) const {
#pragma GCC unroll 4
    for (int i = 0; i < kWide; ++i) {
      if (8 * i + 8 <= rows) {
        storeWide(p + 8 * i, wide[i]);
      } else {
        store(p + 8 * i, lower(wide[i]));
        storeSome(p + 8 * i + 4, upper(wide[i]), rows - 8 * i - 4);
      }
    }
    if constexpr (H % 2 != 0) storeSome(p + 8 * kWide, narrow, rows - 8 * kWide);
  }
  SLOM_INLINE void add(const Column& a, const Factor& b) {
#pragma GCC unroll 4
    for (int i = 0; i < kWide; ++i) wide[i] = plusProduct(wide[i], a.wide[i], b.wide);
    if constexpr (H % 2 != 0) narrow = plusProduct(narrow, a.narrow, b.narrow);
  }
  SLOM_INLINE void subtract(const Column& a, const Factor& b) {
#pragma GCC unroll 4
    for (int i = 0; i < kWide; ++i) wide[i] = minusProduct(wide[i], a.wide[i], b.wide);
    if constexpr (H % 2 != 0) narrow = minusProduct(narrow, a.narrow, b.narrow);
  }
  SLOM_INLINE void scale(const Factor& b) {
#pragma GCC unroll 4
    for (int i = 0; i < kWide; ++i) wide[i] *= b.wide;
    if constexpr (H % 2 != 0) narrow *= b.narrow;
  }
  SLOM_INLINE Vector part(int h) const { return h == 2 * kWide ? narrow : h % 2 == 0 ? lower(wide[h / 2]) : upper(wide[h / 2]); }
  /// One of the first four numbers.
  SLOM_INLINE double get(int i) const {
    if constexpr (kWide > 0) {
      return wide[0][i];
    } else {
      return narrow[i];
    }
  }
  SLOM_INLINE void set(int i, double x) {
    if constexpr (kWide > 0) {
      wide[0][i] = x;
    } else {
      narrow[i] = x;
    }
  }
};
template <int H>
SLOM_INLINE inline Column<H> columnOf(const Vector (&parts)[H]) {
  Column<H> x = {};
#pragma GCC unroll 4
  for (int i = 0; i < H / 2; ++i) x.wide[i] = __builtin_shufflevector(parts[2 * i], parts[2 * i + 1], 0, 1, 2, 3, 4, 5, 6, 7);
  if constexpr (H % 2 != 0) x.narrow = parts[H - 1];
  return x;
}
#else
/// The same number in all lanes.
struct Factor {
  Vector all_lanes;
  SLOM_INLINE explicit Factor(double x) : all_lanes(all(x)) {}
};
template <int H>
struct Column {
  Vector v[H];

  SLOM_INLINE static Column zero() {
    Column x;
#pragma GCC unroll 4
    for (int h = 0; h < H; ++h) x.v[h] = all(0);
    return x;
  }
  /// `rows` numbers, more than 4 (H - 1), padded with 0.
  SLOM_INLINE static Column loaded(const double* p, int rows = 4 * H) {
    Column x;
#pragma GCC unroll 4
    for (int h = 0; h < H; ++h) x.v[h] = loadSome(p + kLanes * h, smaller(kLanes, rows - kLanes * h));
    return x;
  }
  SLOM_INLINE void storeTo(double* p, int rows = 4 * H) const {
#pragma GCC unroll 4
    for (int h = 0; h < H; ++h) storeSome(p + kLanes * h, v[h], smaller(kLanes, rows - kLanes * h));
  }
  SLOM_INLINE void add(const Column& a, const Factor& b) {
#pragma GCC unroll 4
    for (int h = 0; h < H; ++h) v[h] = plusProduct(v[h], a.v[h], b.all_lanes);
  }
  SLOM_INLINE void subtract(const Column& a, const Factor& b) {
#pragma GCC unroll 4
    for (int h = 0; h < H; ++h) v[h] = minusProduct(v[h], a.v[h], b.all_lanes);
  }
  SLOM_INLINE void scale(const Factor& b) {
#pragma GCC unroll 4
    for (int h = 0; h < H; ++h) v[h] *= b.all_lanes;
  }
  SLOM_INLINE Vector part(int h) const { return v[h]; }
  /// One of the first four numbers.
  SLOM_INLINE double get(int i) const { return v[0][i]; }
  SLOM_INLINE void set(int i, double x) { v[0][i] = x; }
};
template <int H>
SLOM_INLINE inline Column<H> columnOf(const Vector (&parts)[H]) {
  Column<H> x;
#pragma GCC unroll 4
  for (int h = 0; h < H; ++h) x.v[h] = parts[h];
  return x;
}
#endif

#if defined(__AVX512F__)
/// Nine numbers, the size of a camera's block: a wide vector and a single number. Functions as those of Column.
struct Nine {
  Wide wide;
  double last;

  SLOM_INLINE static Nine zero() { return {allWide(0), 0}; }
  SLOM_INLINE static Nine loaded(const double* p, int = 9) { return {loadWide(p), p[8]}; }
  /// Stores 9 rows, or 12 with 0 in the last three.
  SLOM_INLINE void storeTo(double* p, int rows = 12) const {
    storeWide(p, wide);
    rows == 9 ? void(p[8] = last) : store(p + 8, Vector{last, 0, 0, 0});
  }
  SLOM_INLINE void add(const Nine& a, const Factor& b) {
    wide = plusProduct(wide, a.wide, b.wide);
    last = plusProduct(last, a.last, b.narrow[0]);
  }
  SLOM_INLINE void subtract(const Nine& a, const Factor& b) {
    wide = minusProduct(wide, a.wide, b.wide);
    last = minusProduct(last, a.last, b.narrow[0]);
  }
  SLOM_INLINE void scale(const Factor& b) {
    wide *= b.wide;
    last *= b.narrow[0];
  }
  SLOM_INLINE Vector part(int h) const { return h == 0 ? lower(wide) : h == 1 ? upper(wide) : Vector{last, 0, 0, 0}; }
};
template <int K>
using ColumnOf = std::conditional_t<K == 9, Nine, Column<padded(K) / kLanes>>;
#else
/// The K rows of a column, padded with 0.
template <int K>
using ColumnOf = Column<padded(K) / kLanes>;
#endif
template <int K>
SLOM_INLINE inline ColumnOf<K> columnOfParts(const Vector (&parts)[padded(K) / kLanes]) {
  if constexpr (std::is_same_v<ColumnOf<K>, Column<padded(K) / kLanes>>) {
    return columnOf(parts);
  } else {
    return {__builtin_shufflevector(parts[0], parts[1], 0, 1, 2, 3, 4, 5, 6, 7), parts[2][0]};
  }
}
template <int K>
SLOM_INLINE inline ColumnOf<K> loadColumn(const double* column) {
  return ColumnOf<K>::loaded(column, K);
}
template <int K>
SLOM_INLINE inline void storeColumn(double* column, const ColumnOf<K>& x) {
  x.storeTo(column, K);
}

/// Entries [4 V, 4 V + 4) of a 3 x 3 block y z^T, column-major, need these of y and of z.
template <int V>
SLOM_INLINE inline Vector rowsOfThree(Vector y) {
  return __builtin_shufflevector(y, y, 4 * V % 3, (4 * V + 1) % 3, (4 * V + 2) % 3, (4 * V + 3) % 3);
}
template <int V>
SLOM_INLINE inline Vector columnsOfThree(Vector z) {
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
  Vector first = all(0), second = all(0);
  double last = 0;
  ThreeByThree() = default;
  explicit ThreeByThree(const double* p) : first(load(p)), second(load(p + 4)), last(p[8]) {}
  void add(const Three& y, const Three& z) {
    first = plusProduct(first, y.rows[0], z.columns[0]);
    second = plusProduct(second, y.rows[1], z.columns[1]);
    last = plusProduct(last, y.last_row, z.last_column);
  }
  void subtract(const Three& y, const Three& z) {
    first = minusProduct(first, y.rows[0], z.columns[0]);
    second = minusProduct(second, y.rows[1], z.columns[1]);
    last = minusProduct(last, y.last_row, z.last_column);
  }
  void storeTo(double* p) const {
    store(p, first);
    store(p + 4, second);
    p[8] = last;
  }
};

/// The columns of a 3 x 3 matrix, with any number in the fourth lane.
SLOM_INLINE inline void columnsOf(const double* A, Vector (&columns)[3]) {
  columns[0] = load(A);
  columns[1] = load(A + 3);
  const Vector last = load(A + 5);
  columns[2] = __builtin_shufflevector(last, last, 1, 2, 3, 3);
}
SLOM_INLINE inline void rowsOf(const double* A, Vector (&rows)[3]) {
  Vector c[3];
  columnsOf(A, c);
  const Vector low = __builtin_shufflevector(c[0], c[1], 0, 4, 1, 5), high = __builtin_shufflevector(c[0], c[1], 2, 6, 2, 6);
  rows[0] = __builtin_shufflevector(low, c[2], 0, 1, 4, 4);
  rows[1] = __builtin_shufflevector(low, c[2], 2, 3, 5, 5);
  rows[2] = __builtin_shufflevector(high, c[2], 0, 1, 6, 6);
}

}  // namespace
}  // namespace slom::dense
