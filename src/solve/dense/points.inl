// Elimination of blocks that never meet.

namespace slom::dense {
namespace {

template <int D, int K>
void solveRightOf(const double* L, const double* W, double* Y) {
  ColumnOf<K> y[D];
#pragma GCC unroll 3
  for (int c = 0; c < D; ++c) {
    y[c] = loadColumn<K>(W + c * K);
#pragma GCC unroll 3
    for (int j = 0; j < c; ++j) y[c].subtract(y[j], Factor(L[j * D + c]));
    y[c].scale(Factor(L[c * D + c]));
    y[c].storeTo(Y + c * padded(K));
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
      for (int i = 0; i < k; ++i) y[i] = minusProduct(y[i], L[j * d + c], Y[j * padded(k) + i]);
    }
    for (int i = 0; i < k; ++i) y[i] *= L[c * d + c];
  }
}

/// Columns [j, j + W) of H, which stay in registers.
template <int D, int K, int W>
void subtractColumns(int j, int padded_l, int count, const Pair* pairs, const double* Y, double* H) {
  ColumnOf<K> x[W];
  double* const columns = H + j * K;
#pragma GCC unroll 9
  for (int w = 0; w < W; ++w) x[w] = loadColumn<K>(columns + w * K);
  for (const Pair* pair = pairs; pair < pairs + count; ++pair) {
    const double* const A = Y + static_cast<std::size_t>(pair->a) * kRowPadding;
    const double* const B = Y + static_cast<std::size_t>(pair->b) * kRowPadding + j;
#pragma GCC unroll 3
    for (int r = 0; r < D; ++r) {
      const auto a = ColumnOf<K>::loaded(A + r * padded(K));
#pragma GCC unroll 9
      for (int w = 0; w < W; ++w) x[w].subtract(a, Factor(B[r * padded_l + w]));
    }
  }
#pragma GCC unroll 9
  for (int w = 0; w < W; ++w) storeColumn<K>(columns + w * K, x[w]);
}

/// Columns that stay in registers together.
#if defined(__AVX512F__)
constexpr int kColumnsAtOnce = 9;
#else
constexpr int kColumnsAtOnce = 3;
#endif

#if defined(__AVX512F__)
/// Blocks of 9 x 9: eight rows in vectors of eight, the last row in one along it.
template <int D>
void subtractNines(int count, const Pair* pairs, const double* Y, double* H) {
  Wide x[9];
#pragma GCC unroll 9
  for (int w = 0; w < 9; ++w) x[w] = loadWide(H + 9 * w);
  Wide row{H[8], H[17], H[26], H[35], H[44], H[53], H[62], H[71]};
  double corner = H[80];
  for (const Pair* pair = pairs; pair < pairs + count; ++pair) {
    const double* const A = Y + static_cast<std::size_t>(pair->a) * kRowPadding;
    const double* const B = Y + static_cast<std::size_t>(pair->b) * kRowPadding;
#pragma GCC unroll 3
    for (int r = 0; r < D; ++r) {
      const Wide a = loadWide(A + r * padded(9));
      const double last = A[r * padded(9) + 8];
      const double* const b = B + r * padded(9);
#pragma GCC unroll 9
      for (int w = 0; w < 9; ++w) x[w] = minusProduct(x[w], a, allWide(b[w]));
      row = minusProduct(row, allWide(last), loadWide(b));
      corner = minusProduct(corner, last, b[8]);
    }
  }
#pragma GCC unroll 9
  for (int w = 0; w < 9; ++w) storeWide(H + 9 * w, x[w]);
#pragma GCC unroll 8
  for (int w = 0; w < 8; ++w) H[9 * w + 8] = row[w];
  H[80] = corner;
}
#endif

template <int D, int K>
void subtractOutersOf(int l, int count, const Pair* pairs, const double* Y, double* H) {
#if defined(__AVX512F__)
  if constexpr (K == 9) {
    if (l == 9) return subtractNines<D>(count, pairs, Y, H);
  }
#endif
  int j = 0;
  for (; j + kColumnsAtOnce <= l; j += kColumnsAtOnce) subtractColumns<D, K, kColumnsAtOnce>(j, padded(l), count, pairs, Y, H);
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
        for (int r = 0; r < d; ++r) H[j * k + i] = minusProduct(H[j * k + i], A[r * padded(k) + i], B[r * padded(l) + j]);
      }
    }
  }
}

template <int D, int K>
void subtractProductOf(const double* W, const double* x, double* y) {
  auto rest = loadColumn<K>(y);
#pragma GCC unroll 3
  for (int c = 0; c < D; ++c) rest.subtract(loadColumn<K>(W + c * K), Factor(x[c]));
  storeColumn<K>(y, rest);
}

void subtractProduct(int d, int k, const double* W, const double* x, double* y) {
  switch (4 * k + d) {
    case 4 * 9 + 3: subtractProductOf<3, 9>(W, x, y); return;
    case 4 * 6 + 3: subtractProductOf<3, 6>(W, x, y); return;
    default: break;
  }
  for (int c = 0; c < d; ++c) {
    for (int i = 0; i < k; ++i) y[i] = minusProduct(y[i], W[c * k + i], x[c]);
  }
}

template <int D, int K>
void subtractTransposedProductOf(const double* W, const double* y, double* x) {
  constexpr int kVectors = padded(K) / kLanes;
  Vector sum[4] = {all(0), all(0), all(0), all(0)};
  const auto rows = loadColumn<K>(y);
#pragma GCC unroll 3
  for (int c = 0; c < D; ++c) {
    const auto column = loadColumn<K>(W + c * K);
#pragma GCC unroll 4
    for (int v = 0; v < kVectors; ++v) sum[c] = plusProduct(sum[c], column.part(v), rows.part(v));
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
    for (int i = 0; i < k; ++i) x[c] = minusProduct(x[c], W[c * k + i], y[i]);
  }
}

}  // namespace
}  // namespace slom::dense
