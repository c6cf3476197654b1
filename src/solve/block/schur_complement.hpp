/// Elimination of many small blocks that never meet each other (points seen by cameras). The others form the reduced
/// system S = H_cc - W V^-1 W^T.
///
///   source   Triggs, McLauchlan, Hartley and Fitzgibbon, "Bundle adjustment - a modern synthesis", 2000, section 6.1
#pragma once

#include <vector>

#include <Eigen/Core>

#include "eliminated_blocks.hpp"
#include "elimination.hpp"
#include "solve/dense/kernels.hpp"

namespace slom {

class SchurComplement final : public Elimination {
 public:
  /// Plans the elimination of the first `eliminated` columns of H, in `flops` operations. `reduced`: graph of the rest,
  /// whose nodes have these positions in S.
  SchurComplement(const BlockLower& H, int eliminated, double flops, const BlockGraph& reduced,
                  const std::vector<int>& position);

  int count() const override { return eliminated_.count(); }
  std::string description() const override { return ""; }
  double flops() const override { return flops_; }
  const BlockLower& S() const override { return S_; }
  /// Computes S := H_cc - W (V + damping)^-1 W^T.
  SolveStatus reduce(const BlockLower& H, const std::vector<int>& offset, const Eigen::VectorXd& damping,
                     double tolerance, Eigen::VectorXd* b) override;
  void forward(const BlockLower& H, const std::vector<int>& offset, Eigen::VectorXd& x) const override;
  void substitute(const BlockLower& H, const std::vector<int>& offset, Eigen::VectorXd& x) const override;
  void invert(const BlockLower& H, const BlockLower& Z, BlockLower& inverse) const override;

 private:
  /// A block of S, or (after all of these) of the right-hand side, in a wave of eliminated blocks, with its pairs.
  struct Meeting {
    int block;
    int first;  ///< first of its pairs
  };
  class Places;
  /// Destination of the Schur terms of eliminated blocks: S and b, or a private accumulator that begins as 0.
  struct Target {
    double *S, *b;
    const int* offset;  ///< first entry in b of each position of S
  };
  void listPairs(const BlockLower& H);
  int choosePartitions() const;
  int waves() const;
  void start(const BlockLower& H);
  EliminatedBlocks::Failure reduceWave(const BlockLower& H, const std::vector<int>& offset,
                                       const Eigen::VectorXd& damping, double tolerance, int wave,
                                       const Eigen::VectorXd* b, const Target& target, double* Y);
  void listWave(const BlockLower& H, int wave, Places& places);
  void halfReduce(const BlockLower& H, int e, double* Y) const;
  void halfReduce(const double* b, int e, int d, double* y) const;

  int vectorSize() const { return depth_ * dense::paddedRows(1); }

  EliminatedBlocks eliminated_;
  BlockLower S_;
  double flops_;
  int depth_ = 0;                   // columns of each block of Y
  std::vector<Meeting> meeting_;    // wave by wave, in each by block; one more for the end
  std::vector<int> first_meeting_;  // first meeting of each wave; one more for the end
  std::vector<dense::Pair> pair_;   // meeting by meeting
  std::vector<int> column_;         // by block of S: its column
  std::vector<int> copied_;         // by block of S: block of H that it starts from; -1: 0
  /// By eliminated block: entries of both `halfReduce` of the blocks before it.
  std::vector<std::size_t> reduced_;
  /// Number of partitions of the waves, for threads. Each except the first has a private accumulator. The number does
  /// not depend on the number of threads.
  int partitions_ = 1;
  std::vector<int> offset_;       // first unknown of each position of S; one more for the end
  std::size_t largest_ = 0;       // numbers of Y in a wave
  dense::BigArray Y_;             // Y of each partition
  dense::BigArray accumulators_;  // accumulators of S and b, of each partition but the first
};

}  // namespace slom
