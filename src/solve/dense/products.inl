// What measurements add to J^T J and J^T r.

namespace slom::dense {
namespace {

constexpr int kMostRows = 16;

/// H += A^T B for A^T of K rows, column after column, each filled up to padded(K); b: distance of B's columns.
template <int K>
inline void accumulate(int rows, int l, const double* A, const double* B, int b, double* H) {
  for (int j = 0; j < l; ++j, B += b, H += K) {
    auto sum = loadColumn<K>(H);
    for (int r = 0; r < rows; ++r) sum.add(ColumnOf<K>::loaded(A + r * padded(K)), Factor(B[r]));
    storeColumn<K>(H, sum);
  }
}

/// H += A^T B for A of K columns: A is transposed first, so that its columns lie across the lanes.
template <int K>
void addProductOf(int rows, int l, const double* A, const double* B, double* H) {
  if constexpr (K <= 2) {  // wide loads of what is stored narrowly would wait for the stores
    for (int j = 0; j < l; ++j, B += rows, H += K) {
      for (int i = 0; i < K; ++i) {
        double sum = H[i];
        for (int r = 0; r < rows; ++r) sum = plusProduct(sum, A[i * rows + r], B[r]);
        H[i] = sum;
      }
    }
    return;
  }
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

/// H += A^T B by dot products of columns, four columns of A at a time.
void addDotProducts(int rows, int k, int l, const double* A, const double* B, double* H) {
  const int whole = rows / kLanes * kLanes;
  const auto addTo = [&](double& entry, double sum, const double* a, const double* b) {
    for (int r = whole; r < rows; ++r) sum = plusProduct(sum, a[r], b[r]);
    entry += sum;
  };
  for (int j = 0; j < l; ++j, B += rows, H += k) {
    for (int i = 0; i < k; i += kLanes) {
      const double* a[kLanes];
      for (int c = 0; c < kLanes; ++c) a[c] = A + static_cast<std::ptrdiff_t>(smaller(i + c, k - 1)) * rows;
      Vector sum[kLanes] = {all(0), all(0), all(0), all(0)};
      for (int r = 0; r < whole; r += kLanes) {
        const Vector b = load(B + r);
        for (int c = 0; c < kLanes; ++c) sum[c] = plusProduct(sum[c], load(a[c] + r), b);
      }
      const Vector total = sums(sum[0], sum[1], sum[2], sum[3]);
      for (int c = 0; c < smaller(kLanes, k - i); ++c) addTo(H[i + c], total[c], a[c], B);
    }
  }
}

void addProduct(int rows, int k, int l, const double* A, const double* B, double* H) {
  if (rows == 0) return;
  switch (k) {
    case 1: addProductOf<1>(rows, l, A, B, H); return;
    case 2: addProductOf<2>(rows, l, A, B, H); return;
    case 3: addProductOf<3>(rows, l, A, B, H); return;
    case 4: addProductOf<4>(rows, l, A, B, H); return;
    case 5: addProductOf<5>(rows, l, A, B, H); return;
    case 6: addProductOf<6>(rows, l, A, B, H); return;
    case 7: addProductOf<7>(rows, l, A, B, H); return;
    case 8: addProductOf<8>(rows, l, A, B, H); return;
    case 9: addProductOf<9>(rows, l, A, B, H); return;
    case 10: addProductOf<10>(rows, l, A, B, H); return;
    case 11: addProductOf<11>(rows, l, A, B, H); return;
    case 12: addProductOf<12>(rows, l, A, B, H); return;
    case 13: addProductOf<13>(rows, l, A, B, H); return;
    case 14: addProductOf<14>(rows, l, A, B, H); return;
    case 15: addProductOf<15>(rows, l, A, B, H); return;
    case 16: addProductOf<16>(rows, l, A, B, H); return;
    default: addDotProducts(rows, k, l, A, B, H); return;
  }
}

void gram(int rows, int columns, int stride, const double* S, double* P) {
  for (int i = 0; i < columns; ++i) {
    for (int j = 0; j <= i; ++j) {
      const double *const a = S + i * stride, *const b = S + j * stride;
      Vector even = all(0), odd = all(0);
      for (int r = 0; r < rows; r += kGramRows) {
        even = plusProduct(even, load(a + r), load(b + r));
        odd = plusProduct(odd, load(a + r + kLanes), load(b + r + kLanes));
      }
      const Vector sum = even + odd;
      P[i * columns + j] = (sum[0] + sum[1]) + (sum[2] + sum[3]);
    }
  }
}

/// A^T B for the columns of B, each R long, added to those of H, each K long: to the same bits as by `accumulate`.
template <int R, int K>
SLOM_INLINE inline void addColumnsOfProduct(const ColumnOf<K> (&A)[R], int columns, const double* B, double* H,
                                            bool is_new = false) {
  for (int j = 0; j < columns; ++j, B += R, H += K) {
    auto sum = is_new ? ColumnOf<K>::zero() : loadColumn<K>(H);
#pragma GCC unroll 6
    for (int r = 0; r < R; ++r) sum.add(A[r], Factor(B[r]));
    storeColumn<K>(H, sum);
  }
}

/// The rows of A, R x K, across the lanes.
template <int R, int K>
SLOM_INLINE inline void transpose(const double* A, ColumnOf<K> (&rows)[R]) {
  constexpr int kVectors = padded(K) / kLanes;
  const auto entry = [&](int r, int i) { return i < K ? A[i * R + r] : 0.0; };
#pragma GCC unroll 6
  for (int r = 0; r < R; ++r) {
    Vector parts[kVectors];
#pragma GCC unroll 4
    for (int v = 0; v < kVectors; ++v) {
      const int i = kLanes * v;
      parts[v] = Vector{entry(r, i), entry(r, i + 1), entry(r, i + 2), entry(r, i + 3)};
    }
    rows[r] = columnOfParts<K>(parts);
  }
}

SLOM_INLINE inline void addToThree(const Vector (&rows)[3], const double* r, double* to) {
  Vector sum{to[0], to[1], to[2], 0};
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) sum = plusProduct(sum, rows[i], all(r[i]));
  for (int i = 0; i < 3; ++i) to[i] = sum[i];
}

/// Three residuals of two variables with three unknowns each.
SLOM_INLINE inline void addPairOfThrees(const PairProduct& pair) {
  Vector a[3], b[3];
  rowsOf(pair.A, a);
  rowsOf(pair.B, b);
  ThreeByThree AA(pair.AA), BB(pair.BB), AB = pair.AB_is_new ? ThreeByThree() : ThreeByThree(pair.AB);
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) {
    const Three left(a[i], a[i]), right(b[i], b[i]);
    AA.add(left, left);
    AB.add(left, right);
    BB.add(right, right);
  }
  AA.storeTo(pair.AA);
  BB.storeTo(pair.BB);
  AB.storeTo(pair.AB);
  addToThree(a, pair.r, pair.Ar);
  addToThree(b, pair.r, pair.Br);
}

template <int R, int K, int L>
SLOM_INLINE inline void addPairOf(const PairProduct& pair) {
  {
    ColumnOf<K> rows[R];
    transpose<R, K>(pair.A, rows);
    addColumnsOfProduct<R, K>(rows, K, pair.A, pair.AA);
    addColumnsOfProduct<R, K>(rows, 1, pair.r, pair.Ar);
    addColumnsOfProduct<R, K>(rows, L, pair.B, pair.AB, pair.AB_is_new);
  }
  ColumnOf<L> rows[R];
  transpose<R, L>(pair.B, rows);
  addColumnsOfProduct<R, L>(rows, L, pair.B, pair.BB);
  addColumnsOfProduct<R, L>(rows, 1, pair.r, pair.Br);
}

template <int R, int K, int L>
bool addPairsOf(int count, const PairProduct* pairs) {
  for (int n = 0; n < count; ++n) {
    if constexpr (R == 3 && K == 3 && L == 3) {
      addPairOfThrees(pairs[n]);
    } else {
      addPairOf<R, K, L>(pairs[n]);
    }
  }
  return true;
}

constexpr int shapeOf(int rows, int k, int l) { return 256 * rows + 16 * k + l; }

bool addPairs(int rows, int k, int l, int count, const PairProduct* pairs) {
  if (rows > 15 || k > 15 || l > 15) return false;
  switch (shapeOf(rows, k, l)) {
    case shapeOf(2, 9, 3): return addPairsOf<2, 9, 3>(count, pairs);
    case shapeOf(2, 6, 3): return addPairsOf<2, 6, 3>(count, pairs);
    case shapeOf(3, 6, 3): return addPairsOf<3, 6, 3>(count, pairs);
    case shapeOf(6, 6, 6): return addPairsOf<6, 6, 6>(count, pairs);
    case shapeOf(3, 3, 3): return addPairsOf<3, 3, 3>(count, pairs);
    case shapeOf(2, 3, 2): return addPairsOf<2, 3, 2>(count, pairs);
    default: return false;
  }
}

}  // namespace
}  // namespace slom::dense
