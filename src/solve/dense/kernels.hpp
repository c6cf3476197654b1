/// The dense arithmetic of the block factorisation, compiled once for each instruction set and chosen at run time.
///
/// Layout. Dense matrices are cut into stripes of kStripe rows; a stripe is stored column after column, so that both
/// operands of a product are read contiguously and nothing is ever packed. Of a front with p pivots and u further rows:
///   D   p x p    lower triangle; stripe s at D + kStripe p s, its column j at + kStripe j
///   B   u x p    the rows below, in the same way; rows that fill up the last stripe are 0
///   U   u x u    lower triangle; stripe s at U + updateOffset(s) has the columns up to its own last row
#pragma once

#include <cstddef>
#include <cstdint>

namespace slom::dense {

inline constexpr int kStripe = 12;

/// Rows of the operands of subtractOuters are filled up to a multiple of this.
inline constexpr int kRowPadding = 4;
constexpr int paddedRows(int k) { return (k + kRowPadding - 1) / kRowPadding * kRowPadding; }

constexpr int stripesOf(int rows) { return (rows + kStripe - 1) / kStripe; }
/// Length to which kernels pad a vector of `rows` entries.
constexpr int paddedToStripes(int rows) { return stripesOf(rows) * kStripe; }
/// Where stripe s of U begins.
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

/// Rows of a child's update that lie next to each other in the parent's stripes too.
struct Run {
  int row;     ///< first row in the child's U
  int length;  ///< <= kStripe, within one stripe of either
  int target;  ///< first row in the parent's front
};

/// The update of a front's child, and where it belongs: its rows in the order of the parent's.
struct Child {
  const Run* runs;
  int run_count;
  const int* column;  ///< kStripe times the parent's row of each of its rows
  int u;
  const double* update;
};

/// One whose rows may be in any order.
struct ShuffledChild : Child {
  const Run* pieces;  ///< as runs, of any length within the pivots or the rows below
  int piece_count;
};

/// A measurement with the residual r and the Jacobians A and B, and what it adds to: blocks of J^T J and parts of J^T r.
struct PairProduct {
  const double *A, *B, *r;
  double *AA, *BB, *AB, *Ar, *Br;
  bool AB_is_new;  ///< AB has no value yet and is taken as 0
};

/// Where two matrices begin, in units of kRowPadding numbers.
struct Pair {
  std::uint32_t a, b;
};

/// Columns that eliminate, forwardColumn and backwardColumn take, at most.
inline constexpr int kMostEliminated = 6;

struct Kernels {
  const char* name;  ///< name of the instruction set
  /// D := its Cholesky factor, inverse[i] := 1 / its diagonal. Returns the first pivot that is not above least[i] and
  /// writes it to *pivot; p when there is none.
  int (*factorize)(double* D, int p, const double* least, double* inverse, double* pivot);
  /// Stripes [first, last) of B := B D^-T
  void (*solveStripes)(const double* D, const double* inverse, int p, double* B, int u, int first, int last);
  /// Stripes [first, last) of the lower triangle of U := -B B^T
  void (*updateStripes)(const double* B, int p, int u, double* U, int first, int last);
  /// Adds to a front's panel what a child's update has in the columns of its pivots.
  void (*addToPanel)(const Child& child, double* D, double* B, int p);
  /// Adds the other columns to the front's own update.
  void (*addToUpdate)(const Child& child, double* U, int p);
  void (*addShuffledToPanel)(const ShuffledChild& child, double* D, double* B, int p);
  void (*addShuffledToUpdate)(const ShuffledChild& child, double* U, int p);
  /// x := D^-1 x
  void (*forwardPivots)(const double* D, const double* inverse, int p, double* x);
  /// y := -B x; y has full stripes
  void (*forwardRows)(const double* B, int p, int u, const double* x, double* y);
  /// x -= B^T y
  void (*backwardRows)(const double* B, int p, int u, const double* y, double* x);
  /// x := D^-T x
  void (*backwardPivots)(const double* D, const double* inverse, int p, double* x);
  /// H += A^T B for A rows x k, B rows x l, H k x l, all column-major and without gaps
  void (*addProduct)(int rows, int k, int l, const double* A, const double* B, double* H);
  /// For each of `count`, in order: AA += A^T A, BB += B^T B, AB += A^T B, Ar += A^T r, Br += B^T r for A rows x k and B rows x l, all as
  /// for addProduct. Returns false, with nothing done, for sizes it is not made for.
  bool (*addPairs)(int rows, int k, int l, int count, const PairProduct* pairs);
  /// Y := W L^-T for W k x d, column-major without gaps, and lower triangular L, d x d, with inverse diagonal; Y has
  /// paddedRows(k) rows, those after the k-th are 0.
  void (*solveRight)(int d, int k, const double* L, const double* W, double* Y);
  /// H -= sum of A_n B_n^T for `count` pairs A_n k x d, B_n l x d in Y, column-major with rows filled up as by solveRight;
  /// H k x l without gaps.
  void (*subtractOuters)(int d, int k, int l, int count, const Pair* pairs, const double* Y, double* H);
  /// y -= W x and x -= W^T y for W k x d, column-major without gaps
  void (*subtractProduct)(int d, int k, const double* W, const double* x, double* y);
  void (*subtractTransposedProduct)(int d, int k, const double* W, const double* y, double* x);
  /// A column of a block factorisation: V, d x d, and `count` blocks W_i below it, height[i] x d, all column-major, the W_i
  /// contiguous. V := L D^-1 in V = L D L^T, with unit lower L; W_i := W_i L^-T; for i and j <= i, in this order, target -=
  /// W_i D^-1 W_j^T (the W as they are then). Where x is not null, what forwardColumn does. Returns the first pivot that is not
  /// above least[i] and writes it to *pivot; d when there is none.
  int (*eliminate)(int d, int count, const int* height, double* V, double* W, double* const* target,
                   const double* least, double* pivot, double* x, double* const* below);
  /// x := L^-1 x and below[i] -= W_i D^-1 x
  void (*forwardColumn)(int d, int count, const int* height, const double* V, const double* W, double* x,
                        double* const* below);
  /// x := L^-T D^-1 (x - sum of W_i^T below[i])
  void (*backwardColumn)(int d, int count, const int* height, const double* V, const double* W,
                         const double* const* below, double* x);
};

/// The kernels for this processor.
const Kernels& kernels();

}  // namespace slom::dense
