/// Elimination of blocks with few neighbours, one after the other, into the system of the others: a block
/// Cholesky factorisation V = L D L^T, column by column, whose updates go straight to where they belong.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "block_lower.hpp"
#include "slom/solve/linear_solver.hpp"
#include "solve/dense/big_array.hpp"
#include "solve/dense/kernels.hpp"
#include "solve/symbolic/low_degree.hpp"

namespace slom {

class LowDegreeElimination {
 public:
  /// H is laid out for `blocks.filled`, with the eliminated blocks first, in their order. `position`: of each
  /// kept block in S; in H their positions are behind the eliminated ones, in the same order.
  void analyze(const BlockLower& H, const LowDegree& blocks, const std::vector<int>& position);

  int count() const { return static_cast<int>(columns_.size()); }
  /// Operations, additions and multiplications.
  double flops() const { return flops_; }
  const BlockLower& S() const { return S_; }

  /// Factorises the eliminated columns of H + damping and makes S, without damping. Vectors by unknown;
  /// offset: first unknown of each position of H. A pivot below the share `tolerance` of the diagonal entry
  /// of H + damping ends it. x, where given, goes through `forward` on the way.
  SolveStatus reduce(const BlockLower& H, const std::vector<int>& offset, const Eigen::VectorXd& damping,
                     double tolerance, Eigen::VectorXd* x = nullptr);
  /// x := L^-1 x, in place: what is left for S, and for the eliminated blocks what `substitute` takes.
  void forward(const std::vector<int>& offset, Eigen::VectorXd& x) const;
  /// x_e for the eliminated blocks, when x has the solution for the others.
  void substitute(const std::vector<int>& offset, Eigen::VectorXd& x) const;
  /// The blocks of the whole inverse in the eliminated columns, into `inverse`, laid out as H; Z: those of
  /// the inverse of S, laid out as that.
  void invert(const BlockLower& H, const BlockLower& Z, BlockLower& inverse) const;

 private:
  struct Column {
    double *V = nullptr, *W = nullptr;  // in factor_: the diagonal block, and those below it
    int first_below = 0, below = 0;  // in height_ and row_
    int first_target = 0;            // in target_
  };

  using Below = std::array<double*, kMostRowsBelow>;  // parts of a vector
  void layOutFactor(const BlockLower& H, int count);
  void prefetchTargets(const Column& column) const;
  void findBelow(const Column& column, const std::vector<int>& offset, Eigen::VectorXd& x, Below& below) const;

  BlockLower S_;
  double flops_ = 0;
  std::vector<Column> columns_;
  std::vector<int> dof_;           // of each column
  std::vector<int> height_, row_;  // of the blocks below the diagonal ones; positions in H
  std::vector<double*> target_;    // of the pairs (i, j <= i) of blocks below: a block of factor_ or S_
  std::size_t diagonal_size_ = 0, below_size_ = 0;  // of what is eliminated
  dense::BigArray factor_;
  std::vector<double> least_;  // pivots, by unknown in the order of elimination
};

}  // namespace slom
