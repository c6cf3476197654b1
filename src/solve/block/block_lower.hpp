/// A symmetric matrix in blocks: its lower triangle, in an order of elimination.
#pragma once

#include <cstddef>
#include <vector>

#include "solve/dense/big_array.hpp"
#include "solve/symbolic/graph.hpp"

namespace slom {

/// Column after column; in each the diagonal block (stored whole) first and then the blocks below it by position. Each
/// block is column-major and contiguous; the values of the diagonal blocks lie before all others, one after the other, as
/// many passes go over them alone. Rows and columns are positions in the order of elimination.
class BlockLower {
 public:
  /// A block for each edge of the graph and one for each node, with any numbers. `position`: of each node in the order of elimination.
  void layOut(const BlockGraph& graph, const std::vector<int>& position);
  /// As another one, with any numbers.
  void layOutAs(const BlockLower& other);

  int columns() const { return static_cast<int>(dof_.size()); }
  int dof(int position) const { return dof_[static_cast<std::size_t>(position)]; }
  /// The blocks of column j are [begin(j), begin(j + 1)).
  int begin(int j) const { return column_[static_cast<std::size_t>(j)]; }
  int row(int block) const { return row_[static_cast<std::size_t>(block)]; }
  const double* values(int block) const { return values_.data() + start_[static_cast<std::size_t>(block)]; }
  double* values(int block) { return values_.data() + start_[static_cast<std::size_t>(block)]; }
  /// Numbers in all blocks, and in those on the diagonal.
  std::size_t size() const { return start_.back(); }
  std::size_t diagonalSize() const { return diagonal_size_; }
  /// The block of row i in column j <= i, which must be there.
  int find(int i, int j) const;

  /// x^T A x; offset[j]: where the unknowns of position j begin in x.
  double squaredForm(const std::vector<int>& offset, const double* x) const;

 private:
  std::vector<int> dof_;
  std::vector<int> column_, row_;
  std::vector<std::size_t> start_;  // first value of each block; one more for the end
  std::size_t diagonal_size_ = 0;
  dense::BigArray values_;
};

}  // namespace slom
