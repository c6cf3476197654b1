/// A symmetric matrix in blocks: its lower triangle, in an order of elimination.
#pragma once

#include <cstddef>
#include <vector>

#include "solve/dense/big_array.hpp"
#include "solve/symbolic/graph.hpp"

namespace slom {

/// Blocks stored column after column: in each column first the diagonal block (stored whole), then the blocks below it
/// by position. Each block is column-major and contiguous. The values of the diagonal blocks come first, one after
/// another, because many passes visit only them. Rows and columns are positions in the order of elimination.
class BlockLower {
 public:
  /// Makes a block for each edge and each node of the graph, with undefined numbers. `position`: by node, its place in
  /// the order of elimination.
  void layOut(const BlockGraph& graph, const std::vector<int>& position);
  /// Lays out blocks as `other` does, with undefined numbers.
  void layOutAs(const BlockLower& other);

  int columns() const { return static_cast<int>(dof_.size()); }
  int dof(int position) const { return dof_[static_cast<std::size_t>(position)]; }
  /// Returns the first block of column j. The blocks of column j are [begin(j), begin(j + 1)).
  int begin(int j) const { return column_[static_cast<std::size_t>(j)]; }
  int row(int block) const { return row_[static_cast<std::size_t>(block)]; }
  const double* values(int block) const { return values_.data() + start_[static_cast<std::size_t>(block)]; }
  double* values(int block) { return values_.data() + start_[static_cast<std::size_t>(block)]; }
  /// Returns the count of numbers in all blocks; diagonalSize(): in the diagonal blocks.
  std::size_t size() const { return start_.back(); }
  std::size_t diagonalSize() const { return diagonal_size_; }
  /// Returns the block of row i in column j <= i, which must exist.
  int find(int i, int j) const;

  /// Returns x^T A x. offset[j]: first unknown of position j in x.
  double squaredForm(const std::vector<int>& offset, const double* x) const;

 private:
  std::vector<int> dof_;
  std::vector<int> column_, row_;
  std::vector<std::size_t> start_;  // first value of each block; one more for the end
  std::size_t diagonal_size_ = 0;
  dense::BigArray values_;
};

}  // namespace slom
