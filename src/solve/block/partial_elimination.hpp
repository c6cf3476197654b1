/// Elimination of blocks with few neighbours, one after another, into the system of the others. It is a block Cholesky
/// factorisation V = L D L^T, column by column. Its updates go directly to their destinations.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "elimination.hpp"
#include "solve/dense/big_array.hpp"
#include "solve/dense/kernels.hpp"
#include "solve/symbolic/partial_minimum_degree.hpp"

namespace slom {

class PartialElimination final : public Elimination {
 public:
  /// Plans the elimination. H is laid out for `blocks.filled`. `position`: place of each kept block in S.
  PartialElimination(const BlockLower& H, const PartialMinimumDegree& blocks,
                     const std::vector<int>& position);

  int count() const override { return static_cast<int>(columns_.size()); }
  std::string description() const override {
    return std::to_string(count()) + " blocks with few neighbours first";
  }
  double flops() const override { return flops_; }
  const BlockLower& S() const override { return S_; }
  SolveStatus reduce(const BlockLower& H, const std::vector<int>& offset, const Eigen::VectorXd& damping,
                     double tolerance, Eigen::VectorXd* x) override;
  void forward(const BlockLower& H, const std::vector<int>& offset, Eigen::VectorXd& x) const override;
  void substitute(const BlockLower& H, const std::vector<int>& offset, Eigen::VectorXd& x) const override;
  void invert(const BlockLower& H, const BlockLower& Z, BlockLower& inverse) const override;

 private:
  struct Column {
    double *V = nullptr, *W = nullptr;  // in factor_: the diagonal block, and those below it
    int first_below = 0, below = 0;     // in height_ and row_
    int first_target = 0;               // in target_
  };

  using Below = std::array<double*, kMostRowsBelow>;  // parts of a vector
  void layOutFactor(const BlockLower& H, int count);
  void prefetchTargets(const Column& column) const;
  void findBelow(const Column& column, const std::vector<int>& offset, Eigen::VectorXd& x,
                 Below& below) const;

  BlockLower S_;
  double flops_ = 0;
  std::vector<Column> columns_;
  std::vector<int> dof_;           // by column: degrees of freedom
  std::vector<int> height_, row_;  // of the blocks below the diagonal: heights, positions in H
  std::vector<double*> target_;    // by pair (i, j <= i) of blocks below: a block of factor_ or S_
  std::size_t diagonal_size_ = 0, below_size_ = 0;  // sizes of the eliminated part
  dense::BigArray factor_;
  std::vector<double> least_;  // least pivots, by unknown in the order of elimination
};

}  // namespace slom
