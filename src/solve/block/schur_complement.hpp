/// Elimination of many small blocks that never meet each other (points that cameras see): what is left is the reduced
/// system S = H_cc - W V^-1 W^T of the other blocks.
///
///   source   Triggs, McLauchlan, Hartley and Fitzgibbon, "Bundle adjustment - a modern synthesis", 2000, section 6.1
#pragma once

#include <vector>

#include <Eigen/Core>

#include "eliminated_blocks.hpp"
#include "slom/solve/linear_solver.hpp"

namespace slom {

/// Whether each block is to be eliminated first: small blocks that never meet, those with few neighbours before others.
/// Empty unless they are most of all blocks.
std::vector<char> independentBlocks(const BlockGraph& graph);

/// The graph of the blocks that are left; two are neighbours if they were, or if both had an eliminated one as neighbour.
struct ReducedGraph {
  BlockGraph graph;
  std::vector<int> block;  ///< of the full graph, of each node
};
ReducedGraph reduceGraph(const BlockGraph& graph, const std::vector<char>& eliminated);

class SchurComplement {
 public:
  /// The first `eliminated` columns of H are eliminated. `reduced`: graph of the rest, whose nodes have these positions in
  /// S; in H their positions are behind the eliminated ones, in the same order.
  void analyze(const BlockLower& H, int eliminated, const BlockGraph& reduced, const std::vector<int>& position);

  const BlockLower& S() const { return S_; }
  const EliminatedBlocks& eliminated() const { return eliminated_; }

  /// S := H_cc - W (V + damping)^-1 W^T. Vectors by unknown; offset: first unknown of each position of H. A pivot below
  /// the share `tolerance` of its diagonal entry of V + damping ends it.
  SolveStatus reduce(const BlockLower& H, const std::vector<int>& offset, const Eigen::VectorXd& damping, double tolerance);

 private:
  int target(int row, int column) const;
  void halfReduce(const BlockLower& H, int e, double* Y) const;
  void subtractOuter(const BlockLower& H, int e, const double* Y, int first, int last);

  EliminatedBlocks eliminated_;
  BlockLower S_;
  std::vector<int> copied_;           // block of H that each block of S starts from, -1: 0
  std::vector<int> table_;            // block of S of (row, column), when there are few
  std::vector<std::size_t> reduced_;  // of each eliminated block: entries of `halfReduce` of those before it
  std::vector<double> work_;          // by position in S: products that go to its rows and those before
  std::vector<double> Y_;
};

}  // namespace slom
