// Solution with factorised fronts.

namespace slom::dense {
namespace {

/// Up to three vectors of `count` numbers, padded with 0.
SLOM_INLINE inline void loadStripe(const double* x, int count, Vector (&rows)[3]) {
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
SLOM_INLINE inline void forwardBlock(const double* L, const double* inverse, int count, Vector (&rest)[3], double* x) {
  if constexpr (K < kStripe) {
    if (K >= count) return;
    const Vector own = all(rest[K / kLanes][K % kLanes] * inverse[K]);
    x[K] = own[0];
#pragma GCC unroll 3
    for (int h = K / kLanes; h < 3; ++h) rest[h] = minusProduct(rest[h], load(L + kStripe * K + kLanes * h), own);
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
      for (int h = 0; h < 3; ++h) rest[h] = minusProduct(rest[h], load(D + kStripe * j + kLanes * h), own);
    }
    forwardBlock<0>(D + kStripe * first, inverse + first, count, rest, x + first);
  }
}

/// x -= B^T y for W columns of B, u x W, whose stripes are `distance` apart.
template <int W>
SLOM_INLINE inline void subtractTransposed(const double* B, std::ptrdiff_t distance, int u, const double* y, double* x) {
  Vector sum[4] = {all(0), all(0), all(0), all(0)};
  for (int row = 0; row < u; row += kStripe, B += distance) {
    Vector rows[3];
    loadStripe(y + row, smaller(kStripe, u - row), rows);
#pragma GCC unroll 4
    for (int w = 0; w < W; ++w) {
#pragma GCC unroll 3
      for (int h = 0; h < 3; ++h) sum[w] = plusProduct(sum[w], load(B + kStripe * w + kLanes * h), rows[h]);
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
      for (int j = 0; j < k; ++j) own[j] = minusProduct(own[j], block[kStripe * j + k], own[k]);
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
        sum[h] = minusProduct(sum[h], load(column + kLanes * h), all(x[j]));
        odd[h] = minusProduct(odd[h], load(column + kStripe + kLanes * h), all(x[j + 1]));
      }
    }
#pragma GCC unroll 3
    for (int h = 0; h < 3; ++h) {
      if (j < p) sum[h] = minusProduct(sum[h], load(column + kLanes * h), all(x[j]));
      store(y + kLanes * h, sum[h] + odd[h]);
    }
  }
}

void backwardRows(const double* B, int p, int u, const double* y, double* x) {
  subtractTransposed(B, static_cast<std::ptrdiff_t>(kStripe) * p, u, y, p, x);
}

}  // namespace
}  // namespace slom::dense
