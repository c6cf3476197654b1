/// Block Cholesky factorisation P (H + damping) P^T = L L^T by the multifrontal method, and the solution with it.
///
/// Memory is laid out once, in `analyze`: L as one panel for each front (see dense/kernels.hpp), updates in arenas whose
/// places are planned, one arena for each subtree that is worked on alone and one for what is above them. The cut into
/// subtrees depends on the structure alone, so results are bitwise the same for any number of threads.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "block_lower.hpp"
#include "slom/solve/linear_solver.hpp"
#include "solve/dense/big_array.hpp"
#include "solve/dense/kernels.hpp"
#include "solve/symbolic/supernodes.hpp"

namespace slom {

class MultifrontalCholesky {
 public:
  /// `offset`: first unknown of each block of the graph that the fronts were made from.
  void analyze(const std::vector<int>& offset, Fronts fronts, const BlockLower& H);
  const Fronts& fronts() const { return fronts_; }

  /// Factorises H + damping (by unknown; may be empty). A pivot below the share `tolerance` of its diagonal entry ends it. A
  /// right-hand side b is solved forward at the same time, while each front is in the cache: backSolve() then ends the solution for it.
  SolveStatus factorize(const BlockLower& H, const Eigen::VectorXd& diagonal, const Eigen::VectorXd& damping,
                        double tolerance, const Eigen::VectorXd* b = nullptr);
  /// The first half of the solution for b, where the factorisation did not take it along, and the rest of it:
  /// (H + damping)^-1 b, by unknown.
  void forwardSolve(const Eigen::VectorXd& b);
  Eigen::VectorXd backSolve();
  /// The blocks of (H + damping)^-1 at the places of H's, into Z, which is laid out as H.
  void invertSelected(BlockLower& Z) const;

 private:
  struct Entry {  // a block of H in its front
    int block, row, column, height, width;
  };
  struct Layout {
    std::size_t D = 0, B = 0;             // in L_
    std::size_t U = 0;                    // in updates_
    int first_child = 0, last_child = 0;  // in children_
    int first_run = 0, last_run = 0;      // in runs_; of this front's rows in its parent
    std::size_t relative = 0;             // in relative_; likewise
    int first_entry = 0, last_entry = 0;  // in entries_
    std::size_t vector = 0;               // in vectors_
  };
  struct Failure {
    int pivot = -1;  // position of the unknown in the permuted system
    double value = 0;
  };

  /// Less work than this [flops] is not worth being handed to another thread.
  static constexpr double kSmallestTask = 1e6;
  static double work(const Front& front);

  void layOut();
  void relate();
  void findEntries(const BlockLower& H);
  void cutIntoSubtrees();
  void planUpdates(bool is_sequential);
  void assemble(const BlockLower& H, const Front& front, const Layout& layout);
  Failure factorizeFront(const BlockLower& H, int f, bool in_parallel);
  Failure factorizeSubtree(const BlockLower& H, int subtree);
  Failure factorizeSubtrees(const BlockLower& H);
  Failure factorizeSequentially(const BlockLower& H);
  template <class F>
  void forEachSubtree(const F& f) const;
  void begin(const Eigen::VectorXd& b);
  void forward(int f);
  Eigen::MatrixXd invertFront(int f, const Eigen::MatrixXd& above, BlockLower& Z) const;
  void backward(int f);

  Fronts fronts_;
  std::vector<int> unknown_;  // at each place of the permuted system
  std::vector<Layout> layout_;
  std::vector<int> children_;
  std::vector<dense::Run> runs_;
  std::vector<int> relative_;
  std::vector<Entry> entries_;
  std::vector<std::vector<int>> subtree_;  // fronts of each, and last those above them
  std::vector<int> subtree_of_;
  bool is_sequential_ = false;   // places of updates are for one thread alone
  bool solves_forward_ = false;  // a right-hand side, in the factorisation at work
  dense::BigArray L_, updates_;
  std::vector<double> inverse_, least_, shift_, vectors_, x_;
};

}  // namespace slom
