// A block Cholesky factorisation column by column.

namespace slom::dense {
namespace {

/// V := L D^-1 for D x D; the first pivot that is too small, D when there is none.
template <int D>
SLOM_INLINE inline int factorizeUnit(int d, double* V, const double* least,
                                                        double* pivot) {
  const int n = D > 0 ? D : d;
  for (int j = 0; j < n; ++j) {
    double* const column = V + j * n;
    for (int k = 0; k < j; ++k) {
      const double scaled =
          V[k * n + j] * V[k * n + k];  // an entry of L D, as earlier columns are scaled when they are finished
      for (int i = j; i < n; ++i) column[i] = minusProduct(column[i], V[k * n + i], scaled);
    }
    if (!(column[j] > least[j])) {
      *pivot = column[j];
      return j;
    }
    column[j] = 1 / column[j];
  }
  for (int j = 0; j < n; ++j) {
    for (int i = j + 1; i < n; ++i) V[j * n + i] *= V[j * n + j];
  }
  return n;
}

template <int D>
void forwardColumnOf(int d, int count, const int* height, const double* V, const double* W, double* x, double* const* below) {
  constexpr int kMost = D > 0 ? D : kMostEliminated;
  const int n = D > 0 ? D : d;
  double scaled[kMost];
  for (int k = 0; k < n; ++k) {
    for (int i = k + 1; i < n; ++i) x[i] = minusProduct(x[i], V[k * n + i], x[k]);
    scaled[k] = x[k] * V[k * n + k];
  }
  for (int i = 0; i < count; ++i) {
    const int rows = D > 0 ? D : height[i];
    double* const y = below[i];
    for (int k = 0; k < n; ++k) {
      for (int r = 0; r < rows; ++r) y[r] = minusProduct(y[r], W[k * rows + r], scaled[k]);
    }
    W += rows * n;
  }
}

constexpr int kMostThrees = 8;

/// Eliminates a column of blocks that are all 3 x 3.
int eliminateThrees(int count, double* V, double* W, double* const* target, const double* least, double* pivot, double* x,
                    double* const* below) {
  const int done = factorizeUnit<3>(3, V, least, pivot);
  if (done < 3) return done;
  const double l10 = V[1], l20 = V[2], l21 = V[5];
  const Vector scale[3] = {all(V[0]), all(V[4]), all(V[8])};
  Vector scaled[3];
  if (x != nullptr) {
    x[1] = minusProduct(x[1], l10, x[0]);
    x[2] = minusProduct(minusProduct(x[2], l20, x[0]), l21, x[1]);
    for (int k = 0; k < 3; ++k) scaled[k] = all(x[k]) * scale[k];
  }
  Three part[kMostThrees][3];
  for (int i = 0; i < count; ++i, W += 9) {
    Vector y[3];
    columnsOf(W, y);
    y[1] = minusProduct(y[1], y[0], all(l10));
    y[2] = minusProduct(minusProduct(y[2], y[0], all(l20)), y[1], all(l21));
    store(W, __builtin_shufflevector(y[0], y[1], 0, 1, 2, 4));
    store(W + 4, __builtin_shufflevector(y[1], y[2], 1, 2, 4, 5));
    W[8] = y[2][2];
#pragma GCC unroll 3
    for (int k = 0; k < 3; ++k) part[i][k] = Three(y[k], y[k] * scale[k]);
    if (x != nullptr) {
      double* const to = below[i];
      const Vector change = plusProduct(plusProduct(y[0] * scaled[0], y[1], scaled[1]), y[2], scaled[2]);
      for (int r = 0; r < 3; ++r) to[r] -= change[r];
    }
    for (int j = 0; j <= i; ++j) {
      ThreeByThree H(*target);
#pragma GCC unroll 3
      for (int k = 0; k < 3; ++k) H.subtract(part[i][k], part[j][k]);
      H.storeTo(*target++);
    }
  }
  return 3;
}

/// The same for blocks of any size, or all of D x D.
template <int D>
int eliminateAny(int d, int count, const int* height, double* V, double* W, double* const* target,
                 const double* least, double* pivot, double* x, double* const* below) {
  const int n = D > 0 ? D : d;
  const int done = factorizeUnit<D>(d, V, least, pivot);
  if (done < n) return done;
  double* Wi = W;
  for (int i = 0; i < count; ++i) {
    const int rows = D > 0 ? D : height[i];
    for (int k = 0; k < n; ++k) {
      for (int c = 0; c < k; ++c) {
        const double l = V[c * n + k];
        for (int r = 0; r < rows; ++r) Wi[k * rows + r] = minusProduct(Wi[k * rows + r], Wi[c * rows + r], l);
      }
    }
    const double* Wj = W;
    for (int j = 0; j <= i; ++j) {
      const int columns = D > 0 ? D : height[j];
      double* const H = *target++;
      for (int c = 0; c < columns; ++c) {
        for (int k = 0; k < n; ++k) {
          const double z = Wj[k * columns + c] * V[k * n + k];
          for (int r = 0; r < rows; ++r) H[c * rows + r] = minusProduct(H[c * rows + r], Wi[k * rows + r], z);
        }
      }
      Wj += columns * n;
    }
    Wi += rows * n;
  }
  if (x != nullptr) forwardColumnOf<D>(d, count, height, V, W, x, below);
  return n;
}

/// Whether all blocks of a column have its own size.
inline bool areAlike(int d, int count, const int* height) {
  for (int i = 0; i < count; ++i) {
    if (height[i] != d) return false;
  }
  return true;
}

int eliminate(int d, int count, const int* height, double* V, double* W, double* const* target,
              const double* least, double* pivot, double* x, double* const* below) {
  if (d == 3 && count <= kMostThrees && areAlike(3, count, height))
    return eliminateThrees(count, V, W, target, least, pivot, x, below);
  if (d == 6 && areAlike(6, count, height)) return eliminateAny<6>(6, count, height, V, W, target, least, pivot, x, below);
  return eliminateAny<0>(d, count, height, V, W, target, least, pivot, x, below);
}

void forwardColumn(int d, int count, const int* height, const double* V, const double* W, double* x, double* const* below) {
  if (d == 3 && areAlike(3, count, height)) return forwardColumnOf<3>(3, count, height, V, W, x, below);
  if (d == 6 && areAlike(6, count, height)) return forwardColumnOf<6>(6, count, height, V, W, x, below);
  forwardColumnOf<0>(d, count, height, V, W, x, below);
}

template <int D>
void backwardColumnOf(int d, int count, const int* height, const double* V, const double* W, const double* const* below,
                      double* x) {
  constexpr int kMost = D > 0 ? D : kMostEliminated;
  const int n = D > 0 ? D : d;
  double rest[kMost];
  for (int k = 0; k < n; ++k) rest[k] = x[k];
  for (int i = 0; i < count; ++i) {
    const int rows = D > 0 ? D : height[i];
    const double* const y = below[i];
    for (int k = 0; k < n; ++k) {
      for (int r = 0; r < rows; ++r) rest[k] = minusProduct(rest[k], W[k * rows + r], y[r]);
    }
    W += rows * n;
  }
  for (int k = n - 1; k >= 0; --k) {
    rest[k] *= V[k * n + k];
    for (int i = k + 1; i < n; ++i) rest[k] = minusProduct(rest[k], V[k * n + i], rest[i]);
    x[k] = rest[k];
  }
}

void backwardColumn(int d, int count, const int* height, const double* V, const double* W, const double* const* below,
                    double* x) {
  if (d == 3 && areAlike(3, count, height)) return backwardColumnOf<3>(3, count, height, V, W, below, x);
  if (d == 6 && areAlike(6, count, height)) return backwardColumnOf<6>(6, count, height, V, W, below, x);
  backwardColumnOf<0>(d, count, height, V, W, below, x);
}

}  // namespace
}  // namespace slom::dense
