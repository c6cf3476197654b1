/// The dense arithmetic of the block factorisation, compiled once for each instruction set and chosen at run time.
///
/// Layout. Dense matrices are cut into stripes of kStripe rows. A stripe is stored column after column, so that both
/// operands of a product are read contiguously and nothing is packed. Matrices of a front with p pivots and u further
/// rows:
///   D   p x p    lower triangle; stripe s at D + kStripe p s, its column j at + kStripe j
///   B   u x p    the rows below, in the same way; padding rows of the last stripe are 0
///   U   u x u    lower triangle; stripe s at U + updateOffset(s) has the columns up to its own last row
#pragma once

#include <cstddef>
#include <cstdint>

namespace slom::dense {

inline constexpr int kStripe = 12;

/// Padding of the operands of subtractOuters: their numbers of rows are rounded up to a multiple of this.
inline constexpr int kRowPadding = 4;
constexpr int paddedRows(int k) { return (k + kRowPadding - 1) / kRowPadding * kRowPadding; }

constexpr int stripesOf(int rows) { return (rows + kStripe - 1) / kStripe; }
/// Returns the length to which kernels pad a vector of `rows` entries.
constexpr int paddedToStripes(int rows) { return stripesOf(rows) * kStripe; }
/// Returns the start of stripe s of U.
constexpr std::size_t updateOffset(int s) {
  return static_cast<std::size_t>(kStripe) * kStripe / 2 * static_cast<std::size_t>(s) *
         static_cast<std::size_t>(s + 1);
}
constexpr std::size_t panelSize(int rows, int p) {
  return static_cast<std::size_t>(kStripe) * static_cast<std::size_t>(stripesOf(rows)) *
         static_cast<std::size_t>(p);
}
constexpr std::size_t updateSize(int u) {
  return u == 0 ? 0
                : updateOffset(stripesOf(u) - 1) +
                      static_cast<std::size_t>(kStripe) * static_cast<std::size_t>(u);
}

/// Rows of a child's update that are adjacent in the parent's stripes too.
struct Run {
  int row;     ///< first row in the child's U
  int length;  ///< <= kStripe, within one stripe of both
  int target;  ///< first row in the parent's front
};

/// The update of a front's child and its destination. Its rows are in the order of the parent's rows.
struct Child {
  const Run* runs;
  int run_count;
  const int* column;  ///< kStripe times the parent's row of each of its rows
  int u;
  const double* update;
};

/// A child whose rows may be in any order.
struct ShuffledChild : Child {
  const Run* pieces;  ///< as runs, of any length within the pivots or the rows below
  int piece_count;
};

/// A measurement with residual r and Jacobians A and B, and its destinations: blocks of J^T J and parts of J^T r.
struct PairProduct {
  const double *A, *B, *r;
  double *AA, *BB, *AB, *Ar, *Br;
  bool AB_is_new;  ///< AB has no value yet and is taken as 0
};

/// The number of rows of gram is a multiple of this.
inline constexpr int kGramRows = 8;

/// Starts of two matrices, in units of kRowPadding numbers.
struct Pair {
  std::uint32_t a, b;
};

/// Largest number of columns of eliminate, forwardColumn and backwardColumn.
inline constexpr int kMostEliminated = 6;

struct Kernels {
  const char* name;  ///< name of the instruction set
  /// Replaces D by its Cholesky factor and sets inverse[i] := 1 / its diagonal. Returns the first pivot that is not
  /// above least[i] and writes it to *pivot; p if there is none.
  int (*factorize)(double* D, int p, const double* least, double* inverse, double* pivot);
  /// Computes stripes [first, last) of B := B D^-T.
  void (*solveStripes)(const double* D, const double* inverse, int p, double* B, int u, int first, int last);
  /// Computes stripes [first, last) of the lower triangle of U := -B B^T.
  void (*updateStripes)(const double* B, int p, int u, double* U, int first, int last);
  /// Adds the columns of a child's update that belong to the front's pivots to the front's panel.
  void (*addToPanel)(const Child& child, double* D, double* B, int p);
  /// Adds the other columns of a child's update to the front's own update.
  void (*addToUpdate)(const Child& child, double* U, int p);
  void (*addShuffledToPanel)(const ShuffledChild& child, double* D, double* B, int p);
  void (*addShuffledToUpdate)(const ShuffledChild& child, double* U, int p);
  /// Computes x := D^-1 x.
  void (*forwardPivots)(const double* D, const double* inverse, int p, double* x);
  /// Computes y := -B x; y has full stripes.
  void (*forwardRows)(const double* B, int p, int u, const double* x, double* y);
  /// Computes x -= B^T y.
  void (*backwardRows)(const double* B, int p, int u, const double* y, double* x);
  /// Computes x := D^-T x.
  void (*backwardPivots)(const double* D, const double* inverse, int p, double* x);
  /// Computes H += A^T B for A rows x k, B rows x l, H k x l, all column-major and contiguous.
  void (*addProduct)(int rows, int k, int l, const double* A, const double* B, double* H);
  /// Computes P := S^T S, the lower triangle of columns x columns, row-major. Column j of S is at S + j stride, with a
  /// multiple of kGramRows rows.
  void (*gram)(int rows, int columns, int stride, const double* S, double* P);
  /// Computes for each of `count`, in order: AA += A^T A, BB += B^T B, AB += A^T B, Ar += A^T r, Br += B^T r for A rows
  /// x k and B rows x l, stored as for addProduct. For unsupported sizes, returns false and does nothing.
  bool (*addPairs)(int rows, int k, int l, int count, const PairProduct* pairs);
  /// Computes Y := W L^-T for W k x d, column-major and contiguous, and lower triangular L, d x d, with inverse
  /// diagonal. Y has paddedRows(k) rows; those after the k-th are 0.
  void (*solveRight)(int d, int k, const double* L, const double* W, double* Y);
  /// Computes H -= sum of A_n B_n^T for `count` pairs A_n k x d, B_n l x d in Y, column-major, padded as by solveRight.
  /// H is k x l and contiguous.
  void (*subtractOuters)(int d, int k, int l, int count, const Pair* pairs, const double* Y, double* H);
  /// Computes y -= W x (and below x -= W^T y) for W k x d, column-major and contiguous.
  void (*subtractProduct)(int d, int k, const double* W, const double* x, double* y);
  void (*subtractTransposedProduct)(int d, int k, const double* W, const double* y, double* x);
  /// Eliminates a column of a block factorisation: V, d x d, and `count` blocks W_i below it, height[i] x d. All are
  /// column-major, the W_i contiguous. V := L D^-1 in V = L D L^T, with unit lower L. W_i := W_i L^-T. For i and j <=
  /// i, in this order, target -= W_i D^-1 W_j^T (with the new W). If x is not null, also does what forwardColumn does.
  /// Returns the first pivot that is not above least[i] and writes it to *pivot; d if there is none.
  int (*eliminate)(int d, int count, const int* height, double* V, double* W, double* const* target,
                   const double* least, double* pivot, double* x, double* const* below);
  /// Computes x := L^-1 x and below[i] -= W_i D^-1 x.
  void (*forwardColumn)(int d, int count, const int* height, const double* V, const double* W, double* x,
                        double* const* below);
  /// Computes x := L^-T D^-1 (x - sum of W_i^T below[i]).
  void (*backwardColumn)(int d, int count, const int* height, const double* V, const double* W,
                         const double* const* below, double* x);
};

/// Returns the kernels for this processor.
const Kernels& kernels();

}  // namespace slom::dense
