// The kernels for one instruction set: included by one source for each, which is compiled for it. Everything is local to
// that source, down to `smaller` instead of std::min: the linker keeps one copy of a library's inline function, and it
// must not be one that was compiled for a newer processor.
#include <cstddef>
#include <utility>

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

/// acc (4 H x W) -= A B^T over K columns of two stripes, A's rows at A, B's at B.
template <int H, int W>
inline __attribute__((always_inline)) void subtractProduct(int K, const double* A, const double* B, Vector (&acc)[W][H]) {
  for (int k = 0; k < K; ++k, A += kStripe, B += kStripe) {
    Vector a[H];
#pragma GCC unroll 3
    for (int h = 0; h < H; ++h) a[h] = load(A + kLanes * h);
#pragma GCC unroll 4
    for (int w = 0; w < W; ++w) {
      const Vector b = all(B[w]);
#pragma GCC unroll 3
      for (int h = 0; h < H; ++h) acc[w][h] -= a[h] * b;
    }
  }
}

/// Columns [k, k + W) of X := (X - X[:, 0:k] L[k:k+W, 0:k]^T) L[k:k+W, k:k+W]^-T for 4 H rows of a stripe; row k + w of
/// L at L + w.
template <int H, int W>
void solveColumns(int k, const double* L, const double* inverse, double* X) {
  Vector acc[W][H];
  double* const at = X + kStripe * k;
#pragma GCC unroll 4
  for (int w = 0; w < W; ++w) {
#pragma GCC unroll 3
    for (int h = 0; h < H; ++h) acc[w][h] = load(at + kStripe * w + kLanes * h);
  }
  subtractProduct<H, W>(k, X, L, acc);
  const double* const triangle = L + kStripe * k;
#pragma GCC unroll 4
  for (int w = 0; w < W; ++w) {
#pragma GCC unroll 4
    for (int v = 0; v < w; ++v) {
      const Vector l = all(triangle[kStripe * v + w]);
#pragma GCC unroll 3
      for (int h = 0; h < H; ++h) acc[w][h] -= acc[v][h] * l;
    }
    const Vector scale = all(inverse[k + w]);
#pragma GCC unroll 3
    for (int h = 0; h < H; ++h) {
      acc[w][h] *= scale;
      store(at + kStripe * w + kLanes * h, acc[w][h]);
    }
  }
}

template <int H>
void solveStripe(const double* D, const double* inverse, int p, double* X, int columns) {
  int k = 0;
  for (; k + 4 <= columns; k += 4) solveColumns<H, 4>(k, D + kStripe * p * (k / kStripe) + k % kStripe, inverse, X);
  const double* const L = D + kStripe * p * (k / kStripe) + k % kStripe;
  switch (columns - k) {
    case 1: solveColumns<H, 1>(k, L, inverse, X); break;
    case 2: solveColumns<H, 2>(k, L, inverse, X); break;
    case 3: solveColumns<H, 3>(k, L, inverse, X); break;
    default: break;
  }
}

/// The W columns from k on of the stripe that holds their diagonal block: pivots and what is below them in the stripe, its
/// last 4 H rows. The first vector holds the pivots; its lanes stay in registers.
template <int H, int W>
int factorizeColumns(int k, double* stripe, const double* least, double* inverse, double* pivot) {
  constexpr int kRow = kStripe - kLanes * H;
  Vector acc[W][H];
  double* const at = stripe + kStripe * k + kRow;
#pragma GCC unroll 4
  for (int w = 0; w < W; ++w) {
#pragma GCC unroll 3
    for (int h = 0; h < H; ++h) acc[w][h] = load(at + kStripe * w + kLanes * h);
  }
  subtractProduct<H, W>(k, stripe + kRow, stripe + kRow, acc);
#pragma GCC unroll 4
  for (int w = 0; w < W; ++w) {
    const double d = acc[w][0][w];
    if (!(d > least[k + w])) {
      *pivot = d;
      return k + w;
    }
    const double root = __builtin_sqrt(d);
    inverse[k + w] = 1 / root;
    const Vector scale = all(1 / root);
#pragma GCC unroll 3
    for (int h = 0; h < H; ++h) acc[w][h] *= scale;
    acc[w][0][w] = root;
#pragma GCC unroll 3
    for (int h = 0; h < H; ++h) store(at + kStripe * w + kLanes * h, acc[w][h]);
#pragma GCC unroll 4
    for (int v = w + 1; v < W; ++v) {
      const Vector l = all(acc[w][0][v]);
#pragma GCC unroll 3
      for (int h = 0; h < H; ++h) acc[v][h] -= acc[w][h] * l;
    }
  }
  return -1;
}

template <int H>
int factorizeColumns(int k, int columns, double* stripe, const double* least, double* inverse, double* pivot) {
  switch (columns) {
    case 1: return factorizeColumns<H, 1>(k, stripe, least, inverse, pivot);
    case 2: return factorizeColumns<H, 2>(k, stripe, least, inverse, pivot);
    case 3: return factorizeColumns<H, 3>(k, stripe, least, inverse, pivot);
    default: return factorizeColumns<H, 4>(k, stripe, least, inverse, pivot);
  }
}

int factorize(double* D, int p, const double* least, double* inverse, double* pivot) {
  for (int s = 0; s < stripesOf(p); ++s) {
    double* const stripe = D + kStripe * p * s;
    const int first = kStripe * s, left = p - first;
    solveStripe<3>(D, inverse, p, stripe, first);
    int bad = factorizeColumns<3>(first, left, stripe, least, inverse, pivot);
    if (bad < 0 && left > 4) bad = factorizeColumns<2>(first + 4, left - 4, stripe, least, inverse, pivot);
    if (bad < 0 && left > 8) bad = factorizeColumns<1>(first + 8, left - 8, stripe, least, inverse, pivot);
    if (bad >= 0) return bad;
  }
  return p;
}

/// Vectors that the rows of stripe s take.
inline int vectorsIn(int rows, int s) { return smaller(kStripe, rows - kStripe * s + kLanes - 1) / kLanes; }

void solveStripes(const double* D, const double* inverse, int p, double* B, int u, int first, int last) {
  for (int s = first; s < last; ++s) {
    double* const X = B + static_cast<std::ptrdiff_t>(kStripe) * p * s;
    switch (vectorsIn(u, s)) {
      case 1: solveStripe<1>(D, inverse, p, X, p); break;
      case 2: solveStripe<2>(D, inverse, p, X, p); break;
      default: solveStripe<3>(D, inverse, p, X, p); break;
    }
  }
}

/// The W columns of C := -A B^T for 4 H rows.
template <int H, int W>
inline void updateTile(int p, const double* A, const double* B, double* C) {
  Vector acc[W][H];
#pragma GCC unroll 4
  for (int w = 0; w < W; ++w) {
#pragma GCC unroll 3
    for (int h = 0; h < H; ++h) acc[w][h] = all(0);
  }
  subtractProduct<H, W>(p, A, B, acc);
#pragma GCC unroll 4
  for (int w = 0; w < W; ++w) {
#pragma GCC unroll 3
    for (int h = 0; h < H; ++h) store(C + kStripe * w + kLanes * h, acc[w][h]);
  }
}
template <int H>
void updateColumns(int p, const double* A, const double* B, double* C, int columns) {
  switch (columns) {
    case 1: updateTile<H, 1>(p, A, B, C); break;
    case 2: updateTile<H, 2>(p, A, B, C); break;
    case 3: updateTile<H, 3>(p, A, B, C); break;
    default: updateTile<H, 4>(p, A, B, C); break;
  }
}
/// All columns left of the diagonal block, then that: of its three groups of columns each begins 4 rows lower.
template <int H>
void updateStripe(const double* B, int p, int u, double* C, int s) {
  const double* const A = B + static_cast<std::ptrdiff_t>(kStripe) * p * s;
  for (int t = 0; t < s; ++t) {
    const double* const other = B + static_cast<std::ptrdiff_t>(kStripe) * p * t;
    for (int k = 0; k < kStripe; k += 4) updateTile<H, 4>(p, A, other + k, C + kStripe * (kStripe * t + k));
  }
  const int own = kStripe * s, width = smaller(kStripe, u - own);
  double* const diagonal = C + kStripe * own;
  updateColumns<H>(p, A, A, diagonal, width);
  if constexpr (H > 1) {
    if (width > 4) updateColumns<H - 1>(p, A + 4, A + 4, diagonal + kStripe * 4 + 4, width - 4);
  }
  if constexpr (H > 2) {
    if (width > 8) updateColumns<H - 2>(p, A + 8, A + 8, diagonal + kStripe * 8 + 8, width - 8);
  }
}

void updateStripes(const double* B, int p, int u, double* U, int first, int last) {
  for (int s = first; s < last; ++s) {
    double* const C = U + updateOffset(s);
    switch (vectorsIn(u, s)) {
      case 1: updateStripe<1>(B, p, u, C, s); break;
      case 2: updateStripe<2>(B, p, u, C, s); break;
      default: updateStripe<3>(B, p, u, C, s); break;
    }
  }
}

/// to[column[j] + i] += from[kStripe j + i] for i < N, first <= j < last
template <int N>
void addColumns(const double* from, double* to, const int* column, int first, int last) {
  for (int j = first; j < last; ++j) {
    const double* const source = from + kStripe * j;
    double* const target = to + column[j];
    int i = 0;
    for (; i + kLanes <= N; i += kLanes) store(target + i, load(target + i) + load(source + i));
    for (; i < N; ++i) target[i] += source[i];
  }
}
template <int... N>
constexpr auto addColumnsTable(std::integer_sequence<int, N...>) {
  struct Table {
    void (*of[sizeof...(N)])(const double*, double*, const int*, int, int);
  };
  return Table{{&addColumns<N + 1>...}};
}
constexpr auto kAddColumns = addColumnsTable(std::make_integer_sequence<int, kStripe>{});

/// How many of the child's columns are pivots of the front.
int pivotsOf(const Child& child, int p) {
  int low = 0, high = child.u;
  while (low < high) {
    const int middle = (low + high) / 2;
    if (child.column[middle] < kStripe * p) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}
/// The triangle of a run with itself.
void addTriangle(const Child& child, const Run& run, const double* from, double* to) {
  for (int j = run.row; j < run.row + run.length; ++j) {
    for (int i = j - run.row; i < run.length; ++i) to[child.column[j] + i] += from[kStripe * j + i];
  }
}

void addToPanel(const Child& child, double* D, double* B, int p) {
  const int pivots = pivotsOf(child, p);
  if (pivots == 0) return;
  for (const Run* run = child.runs; run < child.runs + child.run_count; ++run) {
    const int s = run->row / kStripe, below = run->target - p;
    const double* const from = child.update + updateOffset(s) + run->row % kStripe;
    double* const to = below < 0 ? D + static_cast<std::ptrdiff_t>(kStripe) * p * (run->target / kStripe) + run->target % kStripe
                                 : B + static_cast<std::ptrdiff_t>(kStripe) * p * (below / kStripe) + below % kStripe;
    kAddColumns.of[run->length - 1](from, to, child.column, 0, smaller(pivots, run->row));
    if (below < 0) addTriangle(child, *run, from, to);
  }
}

void addToUpdate(const Child& child, double* U, int p) {
  const int pivots = pivotsOf(child, p);
  for (const Run* run = child.runs; run < child.runs + child.run_count; ++run) {
    const int s = run->row / kStripe, row = run->target - p;
    if (row < 0) continue;
    const double* const from = child.update + updateOffset(s) + run->row % kStripe;
    double* const to = U + (static_cast<std::ptrdiff_t>(updateOffset(row / kStripe)) + row % kStripe - kStripe * p);
    kAddColumns.of[run->length - 1](from, to, child.column, pivots, run->row);
    addTriangle(child, *run, from, to);
  }
}

/// Up to three vectors of `count` numbers, 0 behind the last.
inline __attribute__((always_inline)) void loadStripe(const double* x, int count, Vector (&rows)[3]) {
#pragma GCC unroll 3
  for (int h = 0; h < 3; ++h) {
    const double* const at = x + kLanes * h;
    switch (count - kLanes * h) {
      case 1: rows[h] = Vector{at[0], 0, 0, 0}; break;
      case 2: rows[h] = Vector{at[0], at[1], 0, 0}; break;
      case 3: rows[h] = Vector{at[0], at[1], at[2], 0}; break;
      default: rows[h] = count > kLanes * h ? load(at) : all(0);
    }
  }
}

/// One unknown after the other of a diagonal block: x[K] is found, and what it takes from those after it is subtracted.
template <int K>
inline __attribute__((always_inline)) void forwardBlock(const double* L, const double* inverse, int count, Vector (&rest)[3],
                                                        double* x) {
  if constexpr (K < kStripe) {
    if (K >= count) return;
    const Vector own = all(rest[K / kLanes][K % kLanes] * inverse[K]);
    x[K] = own[0];
#pragma GCC unroll 3
    for (int h = K / kLanes; h < 3; ++h) rest[h] -= load(L + kStripe * K + kLanes * h) * own;
    forwardBlock<K + 1>(L, inverse, count, rest, x);
  }
}

void forwardPivots(const double* D, const double* inverse, int p, double* x) {
  for (int first = 0; first < p; first += kStripe, D += kStripe * p) {
    const int count = smaller(kStripe, p - first);
    Vector rest[3];
    loadStripe(x + first, count, rest);
    for (int j = 0; j < first; ++j) {
      const Vector own = all(x[j]);
#pragma GCC unroll 3
      for (int h = 0; h < 3; ++h) rest[h] -= load(D + kStripe * j + kLanes * h) * own;
    }
    forwardBlock<0>(D + kStripe * first, inverse + first, count, rest, x + first);
  }
}

/// The sum of each vector's lanes.
inline __attribute__((always_inline)) Vector sums(Vector a, Vector b, Vector c, Vector d) {
  const Vector ab = __builtin_shufflevector(a, b, 0, 4, 2, 6) + __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Vector cd = __builtin_shufflevector(c, d, 0, 4, 2, 6) + __builtin_shufflevector(c, d, 1, 5, 3, 7);
  return __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
}

/// x -= B^T y for W columns of B, u x W, whose stripes are `distance` apart.
template <int W>
inline __attribute__((always_inline)) void subtractTransposed(const double* B, std::ptrdiff_t distance, int u, const double* y,
                                                              double* x) {
  Vector sum[4] = {all(0), all(0), all(0), all(0)};
  for (int row = 0; row < u; row += kStripe, B += distance) {
    Vector rows[3];
    loadStripe(y + row, smaller(kStripe, u - row), rows);
#pragma GCC unroll 4
    for (int w = 0; w < W; ++w) {
#pragma GCC unroll 3
      for (int h = 0; h < 3; ++h) sum[w] += load(B + kStripe * w + kLanes * h) * rows[h];
    }
  }
  const Vector result = sums(sum[0], sum[1], sum[2], sum[3]);
#pragma GCC unroll 4
  for (int w = 0; w < W; ++w) x[w] -= result[w];
}
inline void subtractTransposed(const double* B, std::ptrdiff_t distance, int u, const double* y, int columns, double* x) {
  if (u == 0) return;
  int j = 0;
  for (; j + 4 <= columns; j += 4) subtractTransposed<4>(B + kStripe * j, distance, u, y, x + j);
  switch (columns - j) {
    case 1: subtractTransposed<1>(B + kStripe * j, distance, u, y, x + j); break;
    case 2: subtractTransposed<2>(B + kStripe * j, distance, u, y, x + j); break;
    case 3: subtractTransposed<3>(B + kStripe * j, distance, u, y, x + j); break;
    default: break;
  }
}

void backwardPivots(const double* D, const double* inverse, int p, double* x) {
  const std::ptrdiff_t distance = static_cast<std::ptrdiff_t>(kStripe) * p;
  for (int first = kStripe * (stripesOf(p) - 1); first >= 0; first -= kStripe) {
    const int count = smaller(kStripe, p - first), next = first + count;
    const double* const block = D + distance * (first / kStripe) + kStripe * first;
    subtractTransposed(block + distance, distance, p - next, x + next, count, x + first);
    double own[kStripe];
    for (int k = 0; k < count; ++k) own[k] = x[first + k];
    for (int k = count - 1; k >= 0; --k) {
      own[k] *= inverse[first + k];
      x[first + k] = own[k];
      for (int j = 0; j < k; ++j) own[j] -= block[kStripe * j + k] * own[k];
    }
  }
}

void forwardRows(const double* B, int p, int u, const double* x, double* y) {
  for (int s = 0; s < stripesOf(u); ++s, B += static_cast<std::ptrdiff_t>(kStripe) * p, y += kStripe) {
    Vector sum[3] = {all(0), all(0), all(0)}, odd[3] = {all(0), all(0), all(0)};
    const double* column = B;
    int j = 0;
    for (; j + 2 <= p; j += 2, column += 2 * kStripe) {
#pragma GCC unroll 3
      for (int h = 0; h < 3; ++h) {
        sum[h] -= load(column + kLanes * h) * all(x[j]);
        odd[h] -= load(column + kStripe + kLanes * h) * all(x[j + 1]);
      }
    }
#pragma GCC unroll 3
    for (int h = 0; h < 3; ++h) {
      if (j < p) sum[h] -= load(column + kLanes * h) * all(x[j]);
      store(y + kLanes * h, sum[h] + odd[h]);
    }
  }
}

void backwardRows(const double* B, int p, int u, const double* y, double* x) {
  subtractTransposed(B, static_cast<std::ptrdiff_t>(kStripe) * p, u, y, p, x);
}

constexpr int kMostRows = 16;
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

/// H += A^T B for A^T of K rows, column after column, each filled up to padded(K); b: distance of B's columns.
template <int K>
inline void accumulate(int rows, int l, const double* A, const double* B, int b, double* H) {
  constexpr int kVectors = padded(K) / kLanes;
  for (int j = 0; j < l; ++j, B += b, H += K) {
    Vector sum[kVectors];
    loadColumn<K>(H, sum);
    for (int r = 0; r < rows; ++r) {
#pragma GCC unroll 4
      for (int v = 0; v < kVectors; ++v) sum[v] += load(A + r * padded(K) + kLanes * v) * all(B[r]);
    }
    storeColumn<K>(H, sum);
  }
}

/// H += A^T B for A of K columns: A is transposed first, so that its columns lie across the lanes.
template <int K>
void addProductOf(int rows, int l, const double* A, const double* B, double* H) {
  double transposed[kMostRows * padded(K)];
  for (int first = 0; first < rows; first += kMostRows) {
    const int count = smaller(kMostRows, rows - first);
    for (int r = 0; r < count; ++r) {
      for (int i = 0; i < K; ++i) transposed[r * padded(K) + i] = A[i * rows + first + r];
      for (int i = K; i < padded(K); ++i) transposed[r * padded(K) + i] = 0;
    }
    accumulate<K>(count, l, transposed, B + first, rows, H);
  }
}

void addProduct(int rows, int k, int l, const double* A, const double* B, double* H) {
  if (rows == 0) return;
  switch (k) {
    case 1: addProductOf<1>(rows, l, A, B, H); return;
    case 2: addProductOf<2>(rows, l, A, B, H); return;
    case 3: addProductOf<3>(rows, l, A, B, H); return;
    case 4: addProductOf<4>(rows, l, A, B, H); return;
    case 6: addProductOf<6>(rows, l, A, B, H); return;
    case 9: addProductOf<9>(rows, l, A, B, H); return;
    default: break;
  }
  for (int j = 0; j < l; ++j) {
    for (int i = 0; i < k; ++i) {
      double sum = 0;
      for (int r = 0; r < rows; ++r) sum += A[i * rows + r] * B[j * rows + r];
      H[j * k + i] += sum;
    }
  }
}

/// A^T B for the columns of B, each R long, added to those of H, each K long: to the same bits as by `accumulate`.
template <int R, int K>
inline __attribute__((always_inline)) void addColumnsOfProduct(const Vector (&A)[R][padded(K) / kLanes], int columns,
                                                               const double* B, double* H) {
  constexpr int kVectors = padded(K) / kLanes;
  for (int j = 0; j < columns; ++j, B += R, H += K) {
    Vector sum[kVectors];
    loadColumn<K>(H, sum);
#pragma GCC unroll 6
    for (int r = 0; r < R; ++r) {
#pragma GCC unroll 4
      for (int v = 0; v < kVectors; ++v) sum[v] += A[r][v] * all(B[r]);
    }
    storeColumn<K>(H, sum);
  }
}

/// The rows of A, R x K, across the lanes.
template <int R, int K>
inline __attribute__((always_inline)) void transpose(const double* A, Vector (&rows)[R][padded(K) / kLanes]) {
  constexpr int kVectors = padded(K) / kLanes;
  const auto entry = [&](int r, int i) { return i < K ? A[i * R + r] : 0.0; };
#pragma GCC unroll 6
  for (int r = 0; r < R; ++r) {
#pragma GCC unroll 4
    for (int v = 0; v < kVectors; ++v) {
      const int i = kLanes * v;
      rows[r][v] = Vector{entry(r, i), entry(r, i + 1), entry(r, i + 2), entry(r, i + 3)};
    }
  }
}

template <int R, int K, int L>
void addPairOf(const double* A, const double* B, const double* r, const PairTarget& to) {
  {
    Vector rows[R][padded(K) / kLanes];
    transpose<R, K>(A, rows);
    addColumnsOfProduct<R, K>(rows, K, A, to.AA);
    addColumnsOfProduct<R, K>(rows, L, B, to.AB);
    addColumnsOfProduct<R, K>(rows, 1, r, to.Ar);
  }
  Vector rows[R][padded(L) / kLanes];
  transpose<R, L>(B, rows);
  addColumnsOfProduct<R, L>(rows, L, B, to.BB);
  addColumnsOfProduct<R, L>(rows, 1, r, to.Br);
}

constexpr int shapeOf(int rows, int k, int l) { return 256 * rows + 16 * k + l; }

bool addPair(int rows, int k, int l, const double* A, const double* B, const double* r, const PairTarget& to) {
  if (rows > 15 || k > 15 || l > 15) return false;
  switch (shapeOf(rows, k, l)) {
    case shapeOf(2, 9, 3): addPairOf<2, 9, 3>(A, B, r, to); return true;
    case shapeOf(2, 6, 3): addPairOf<2, 6, 3>(A, B, r, to); return true;
    case shapeOf(3, 6, 3): addPairOf<3, 6, 3>(A, B, r, to); return true;
    case shapeOf(6, 6, 6): addPairOf<6, 6, 6>(A, B, r, to); return true;
    case shapeOf(3, 3, 3): addPairOf<3, 3, 3>(A, B, r, to); return true;
    case shapeOf(2, 3, 2): addPairOf<2, 3, 2>(A, B, r, to); return true;
    default: return false;
  }
}

template <int D, int K>
void solveRightOf(const double* L, const double* W, double* Y) {
  constexpr int kVectors = padded(K) / kLanes;
  Vector y[D][kVectors];
#pragma GCC unroll 3
  for (int c = 0; c < D; ++c) {
    loadColumn<K>(W + c * K, y[c]);
#pragma GCC unroll 3
    for (int j = 0; j < c; ++j) {
#pragma GCC unroll 4
      for (int v = 0; v < kVectors; ++v) y[c][v] -= all(L[j * D + c]) * y[j][v];
    }
#pragma GCC unroll 4
    for (int v = 0; v < kVectors; ++v) {
      y[c][v] *= all(L[c * D + c]);
      store(Y + c * padded(K) + kLanes * v, y[c][v]);
    }
  }
}

void solveRight(int d, int k, const double* L, const double* W, double* Y) {
  switch (4 * k + d) {
    case 4 * 9 + 3: solveRightOf<3, 9>(L, W, Y); return;
    case 4 * 6 + 3: solveRightOf<3, 6>(L, W, Y); return;
    case 4 * 3 + 2: solveRightOf<2, 3>(L, W, Y); return;
    default: break;
  }
  for (int c = 0; c < d; ++c) {
    double* const y = Y + c * padded(k);
    for (int i = 0; i < k; ++i) y[i] = W[c * k + i];
    for (int i = k; i < padded(k); ++i) y[i] = 0;
    for (int j = 0; j < c; ++j) {
      for (int i = 0; i < k; ++i) y[i] -= L[j * d + c] * Y[j * padded(k) + i];
    }
    for (int i = 0; i < k; ++i) y[i] *= L[c * d + c];
  }
}

/// Columns [j, j + W) of H, which stay in registers.
template <int D, int K, int W>
void subtractColumns(int j, int padded_l, int count, const Pair* pairs, const double* Y, double* H) {
  constexpr int kVectors = padded(K) / kLanes;
  Vector x[W][kVectors];
  double* const columns = H + j * K;
#pragma GCC unroll 3
  for (int w = 0; w < W; ++w) loadColumn<K>(columns + w * K, x[w]);
  for (const Pair* pair = pairs; pair < pairs + count; ++pair) {
    const double* const A = Y + static_cast<std::size_t>(pair->a) * kRowPadding;
    const double* const B = Y + static_cast<std::size_t>(pair->b) * kRowPadding + j;
#pragma GCC unroll 3
    for (int r = 0; r < D; ++r) {
      Vector a[kVectors];
#pragma GCC unroll 4
      for (int v = 0; v < kVectors; ++v) a[v] = load(A + r * padded(K) + kLanes * v);
#pragma GCC unroll 3
      for (int w = 0; w < W; ++w) {
        const Vector b = all(B[r * padded_l + w]);
#pragma GCC unroll 4
        for (int v = 0; v < kVectors; ++v) x[w][v] -= a[v] * b;
      }
    }
  }
#pragma GCC unroll 3
  for (int w = 0; w < W; ++w) storeColumn<K>(columns + w * K, x[w]);
}

template <int D, int K>
void subtractOutersOf(int l, int count, const Pair* pairs, const double* Y, double* H) {
  int j = 0;
  for (; j + 3 <= l; j += 3) subtractColumns<D, K, 3>(j, padded(l), count, pairs, Y, H);
  for (; j < l; ++j) subtractColumns<D, K, 1>(j, padded(l), count, pairs, Y, H);
}

void subtractOuters(int d, int k, int l, int count, const Pair* pairs, const double* Y, double* H) {
  switch (4 * k + d) {
    case 4 * 9 + 3: subtractOutersOf<3, 9>(l, count, pairs, Y, H); return;
    case 4 * 6 + 3: subtractOutersOf<3, 6>(l, count, pairs, Y, H); return;
    case 4 * 3 + 2: subtractOutersOf<2, 3>(l, count, pairs, Y, H); return;
    default: break;
  }
  for (const Pair* pair = pairs; pair < pairs + count; ++pair) {
    const double* const A = Y + static_cast<std::size_t>(pair->a) * kRowPadding;
    const double* const B = Y + static_cast<std::size_t>(pair->b) * kRowPadding;
    for (int j = 0; j < l; ++j) {
      for (int i = 0; i < k; ++i) {
        for (int r = 0; r < d; ++r) H[j * k + i] -= A[r * padded(k) + i] * B[r * padded(l) + j];
      }
    }
  }
}

template <int D, int K>
void subtractProductOf(const double* W, const double* x, double* y) {
  constexpr int kVectors = padded(K) / kLanes;
  Vector rest[kVectors];
  loadColumn<K>(y, rest);
#pragma GCC unroll 3
  for (int c = 0; c < D; ++c) {
    Vector column[kVectors];
    loadColumn<K>(W + c * K, column);
#pragma GCC unroll 4
    for (int v = 0; v < kVectors; ++v) rest[v] -= column[v] * all(x[c]);
  }
  storeColumn<K>(y, rest);
}

void subtractProduct(int d, int k, const double* W, const double* x, double* y) {
  switch (4 * k + d) {
    case 4 * 9 + 3: subtractProductOf<3, 9>(W, x, y); return;
    case 4 * 6 + 3: subtractProductOf<3, 6>(W, x, y); return;
    default: break;
  }
  for (int c = 0; c < d; ++c) {
    for (int i = 0; i < k; ++i) y[i] -= W[c * k + i] * x[c];
  }
}

template <int D, int K>
void subtractTransposedProductOf(const double* W, const double* y, double* x) {
  constexpr int kVectors = padded(K) / kLanes;
  Vector rows[kVectors], sum[4] = {all(0), all(0), all(0), all(0)};
  loadColumn<K>(y, rows);
#pragma GCC unroll 3
  for (int c = 0; c < D; ++c) {
    Vector column[kVectors];
    loadColumn<K>(W + c * K, column);
#pragma GCC unroll 4
    for (int v = 0; v < kVectors; ++v) sum[c] += column[v] * rows[v];
  }
  const Vector result = sums(sum[0], sum[1], sum[2], sum[3]);
#pragma GCC unroll 3
  for (int c = 0; c < D; ++c) x[c] -= result[c];
}

void subtractTransposedProduct(int d, int k, const double* W, const double* y, double* x) {
  switch (4 * k + d) {
    case 4 * 9 + 3: subtractTransposedProductOf<3, 9>(W, y, x); return;
    case 4 * 6 + 3: subtractTransposedProductOf<3, 6>(W, y, x); return;
    default: break;
  }
  for (int c = 0; c < d; ++c) {
    for (int i = 0; i < k; ++i) x[c] -= W[c * k + i] * y[i];
  }
}

constexpr Kernels makeKernels(const char* name) {
  return {name,          &factorize,   &solveStripes, &updateStripes,  &addToPanel,   &addToUpdate,    &forwardPivots,
          &forwardRows, &backwardRows, &backwardPivots, &addProduct, &addPair, &solveRight, &subtractOuters,
          &subtractProduct, &subtractTransposedProduct};
}

}  // namespace
}  // namespace slom::dense
