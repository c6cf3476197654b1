// Factorisation of fronts, in stripes.

namespace slom::dense {
namespace {

/// acc (4 H x W) -= A B^T over K columns of two stripes, A's rows at A, B's at B.
template <int H, int W>
SLOM_INLINE inline void subtractProduct(int K, const double* A, const double* B, Column<H> (&acc)[W]) {
  for (int k = 0; k < K; ++k, A += kStripe, B += kStripe) {
    const auto a = Column<H>::loaded(A);
#pragma GCC unroll 12
    for (int w = 0; w < W; ++w) acc[w].subtract(a, Factor(B[w]));
  }
}

/// Columns [k, k + W) of X := (X - X[:, 0:k] L[k:k+W, 0:k]^T) L[k:k+W, k:k+W]^-T for 4 H rows of a stripe; row k + w of
/// L at L + w.
template <int H, int W>
void solveColumns(int k, const double* L, const double* inverse, double* X) {
  Column<H> acc[W];
  double* const at = X + kStripe * k;
#pragma GCC unroll 4
  for (int w = 0; w < W; ++w) acc[w] = Column<H>::loaded(at + kStripe * w);
  subtractProduct<H, W>(k, X, L, acc);
  const double* const triangle = L + kStripe * k;
#pragma GCC unroll 4
  for (int w = 0; w < W; ++w) {
#pragma GCC unroll 4
    for (int v = 0; v < w; ++v) acc[w].subtract(acc[v], Factor(triangle[kStripe * v + w]));
    acc[w].scale(Factor(inverse[k + w]));
    acc[w].storeTo(at + kStripe * w);
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
  Column<H> acc[W];
  double* const at = stripe + kStripe * k + kRow;
#pragma GCC unroll 4
  for (int w = 0; w < W; ++w) acc[w] = Column<H>::loaded(at + kStripe * w);
  subtractProduct<H, W>(k, stripe + kRow, stripe + kRow, acc);
#pragma GCC unroll 4
  for (int w = 0; w < W; ++w) {
    const double d = acc[w].get(w);
    if (!(d > least[k + w])) {
      *pivot = d;
      return k + w;
    }
    const double root = __builtin_sqrt(d);
    inverse[k + w] = 1 / root;
    acc[w].scale(Factor(1 / root));
    acc[w].set(w, root);
    acc[w].storeTo(at + kStripe * w);
#pragma GCC unroll 4
    for (int v = w + 1; v < W; ++v) acc[v].subtract(acc[w], Factor(acc[w].get(v)));
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

/// Columns of a tile of an update: as many as there are registers for.
#if defined(__AVX512F__)
constexpr int kTile = 6;
#else
constexpr int kTile = 4;
#endif

/// The W columns of C := -A B^T for 4 H rows.
template <int H, int W>
inline void updateTile(int p, const double* A, const double* B, double* C) {
  Column<H> acc[W];
#pragma GCC unroll 12
  for (int w = 0; w < W; ++w) acc[w] = Column<H>::zero();
  subtractProduct<H, W>(p, A, B, acc);
#pragma GCC unroll 12
  for (int w = 0; w < W; ++w) acc[w].storeTo(C + kStripe * w);
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
    for (int k = 0; k < kStripe; k += kTile) updateTile<H, kTile>(p, A, other + k, C + kStripe * (kStripe * t + k));
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

/// to[kStripe i + j] += from[kStripe j + i] for i < rows, j < columns
void addTransposed(const double* from, double* to, int rows, int columns) {
  int i = 0;
  for (; i + kLanes <= rows; i += kLanes) {
    int j = 0;
    for (; j + kLanes <= columns; j += kLanes) {
      const double* const source = from + kStripe * j + i;
      double* const target = to + kStripe * i + j;
      const Vector a = load(source), b = load(source + kStripe), c = load(source + 2 * kStripe), d = load(source + 3 * kStripe);
      const Vector ab = __builtin_shufflevector(a, b, 0, 4, 2, 6), ba = __builtin_shufflevector(a, b, 1, 5, 3, 7);
      const Vector cd = __builtin_shufflevector(c, d, 0, 4, 2, 6), dc = __builtin_shufflevector(c, d, 1, 5, 3, 7);
      store(target, load(target) + __builtin_shufflevector(ab, cd, 0, 1, 4, 5));
      store(target + kStripe, load(target + kStripe) + __builtin_shufflevector(ba, dc, 0, 1, 4, 5));
      store(target + 2 * kStripe, load(target + 2 * kStripe) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7));
      store(target + 3 * kStripe, load(target + 3 * kStripe) + __builtin_shufflevector(ba, dc, 2, 3, 6, 7));
    }
    for (; j < columns; ++j) {
      for (int k = i; k < i + kLanes; ++k) to[kStripe * k + j] += from[kStripe * j + k];
    }
  }
  for (; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) to[kStripe * i + j] += from[kStripe * j + i];
  }
}

/// What a child adds to the columns of the pivots or to the others; `rowAt` says where a row of these begins, its entries kStripe apart.
template <class RowAt>
SLOM_INLINE inline void addShuffled(const ShuffledChild& child, int p, bool to_panel, const RowAt& rowAt) {
  const auto isHere = [&](int column) { return (column < p) == to_panel; };
  for (const Run* run = child.runs; run < child.runs + child.run_count; ++run) {
    const double* const from = child.update + updateOffset(run->row / kStripe) + run->row % kStripe;
    const Run* piece = child.pieces;
    for (; piece < child.pieces + child.piece_count && piece->row < run->row; ++piece) {
      const int last = smaller(piece->row + piece->length, run->row);
      if (piece->target < run->target) {
        if (isHere(piece->target))
          kAddColumns.of[run->length - 1](from, rowAt(run->target), child.column, piece->row, last);
        continue;
      }
      if (!isHere(run->target)) continue;
      // Above the diagonal of the parent: the rows of the run are columns there.
      for (int j = piece->row, count = 0; j < last; j += count) {
        const int target = piece->target + j - piece->row;
        count = smaller(kStripe - (target < p ? target : target - p) % kStripe, last - j);
        addTransposed(from + kStripe * j, rowAt(target) + kStripe * run->target, run->length, count);
      }
    }
    if (isHere(run->target)) addTriangle(child, *run, from, rowAt(run->target));
  }
}

void addShuffledToPanel(const ShuffledChild& child, double* D, double* B, int p) {
  addShuffled(child, p, true, [&](int row) {
    const auto in = [&](double* panel, int i) {
      return panel + (static_cast<std::ptrdiff_t>(kStripe) * p * (i / kStripe) + i % kStripe);
    };
    return row < p ? in(D, row) : in(B, row - p);
  });
}

void addShuffledToUpdate(const ShuffledChild& child, double* U, int p) {
  addShuffled(child, p, false, [&](int row) {
    const int i = row - p;
    return U + (static_cast<std::ptrdiff_t>(updateOffset(i / kStripe)) + i % kStripe - static_cast<std::ptrdiff_t>(kStripe) * p);
  });
}

}  // namespace
}  // namespace slom::dense
