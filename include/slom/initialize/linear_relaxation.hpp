/// LinearRelaxation: linear least squares between blocks that differ by rotations and offsets, for chordal relaxation.
#pragma once

#include <vector>

#include "mtk/detail/cpp20.hpp"

namespace slom::initialize {

/// Finds the blocks X_k, each rows x columns, that minimise sum w |X_j - M X_i - C|^2, with orthogonal M. Fixed blocks
/// keep their values. The columns share one factorisation, by slom::BlockSolver. Matrices are column-major.
class LinearRelaxation {
 public:
  /// Creates a relaxation without blocks. Each block will be rows x columns.
  LinearRelaxation(int rows, int columns) : rows_(rows), columns_(columns) {}

  /// Adds a block; blocks are numbered from 0 on. A block with a `value` keeps it.
  void addBlock(const double* value = nullptr);
  /// Adds w |X_j - M X_i - C|^2. Throws [slom.bad-information] if w is not positive and finite.
  void add(double w, int i, int j, const double* M, const double* C);
  /// Solves for the blocks. Returns false, with the blocks unchanged, if they are not determined.
  bool solve();
  /// Returns the block's entries, column-major.
  const double* value(int block) const;

 private:
  struct Term {
    double w;
    int i, j;
  };
  double* valueAt(int block);

  int rows_, columns_;
  std::vector<char> is_fixed_;
  std::vector<double> values_;
  std::vector<Term> terms_;
  std::vector<double> M_, C_;  // M and C of each term
};

namespace detail {
/// Replaces an N x N matrix, N = 2 or 3, by the rotation nearest to it in the Frobenius norm.
void nearestRotation(int N, double* M);
/// Throws [slom.undetermined-start].
[[noreturn]] void raiseUndetermined();
}  // namespace detail

}  // namespace slom::initialize
