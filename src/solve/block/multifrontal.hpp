/// Block Cholesky factorisation P (H + damping) P^T = L L^T by the multifrontal method, and the solution with it.
///
/// Memory is laid out once, in `analyze`. L has one panel for each front (see dense/kernels.hpp). Updates are in arenas
/// with planned places: one arena for each subtree that is processed by one thread, and one for the fronts above them.
/// The cut into subtrees depends only on the structure, so results are bitwise the same for any number of threads.
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
  /// Plans the factorisation. `offset`: first unknown of each block of the graph that the fronts were made from.
  void analyze(const std::vector<int>& offset, Fronts fronts, const BlockLower& H);
  const Fronts& fronts() const { return fronts_; }

  /// Factorises H + damping (by unknown; may be empty). Stops at a pivot below the fraction `tolerance` of its diagonal
  /// entry. If b is given, solves it forward while each front is in the cache; then backSolve() completes its solution.
  SolveStatus factorize(const BlockLower& H, const Eigen::VectorXd& diagonal, const Eigen::VectorXd& damping,
                        double tolerance, const Eigen::VectorXd* b = nullptr);
  /// Solves b forward, if the factorisation did not. backSolve() completes the solution: it returns (H + damping)^-1 b,
  /// by unknown.
  void forwardSolve(const Eigen::VectorXd& b);
  Eigen::VectorXd backSolve();
  /// The numbers of a solution while it is computed.
  struct Workspace {
    std::vector<double> x, rows;
  };
  /// Returns (H + damping)^-1 b. Several threads may call it, each with a workspace of its own.
  Eigen::VectorXd solveAlone(const Eigen::VectorXd& b, Workspace& workspace) const;
  /// Writes the blocks of (H + damping)^-1 at the places of H's blocks into Z, which is laid out as H.
  void invertSelected(BlockLower& Z) const;

 private:
  struct Entry {  // a block of H in its front
    int block, row, column, height, width;
  };
  struct Layout {
    std::size_t D = 0, B = 0;             // in L_
    std::size_t U = 0;                    // in updates_
    int first_child = 0, last_child = 0;  // in children_
    int first_run = 0, last_run = 0;      // in runs_; this front's rows in its parent
    std::size_t relative = 0;             // in relative_; this front's rows in its parent
    int first_entry = 0, last_entry = 0;  // in entries_
    std::size_t vector = 0;               // in Workspace::rows
  };
  struct Failure {
    int pivot = -1;  // position of the unknown in the permuted system
    double value = 0;
  };

  /// Work [flops] below which a task is not handed to another thread.
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
  void begin(const Eigen::VectorXd& b, Workspace& solution) const;
  Eigen::VectorXd end(const Workspace& solution) const;
  void forward(int f, Workspace& solution) const;
  Eigen::MatrixXd invertFront(int f, const Eigen::MatrixXd& above, BlockLower& Z) const;
  void backward(int f, Workspace& solution) const;

  Fronts fronts_;
  std::vector<int> unknown_;  // by place of the permuted system
  std::vector<Layout> layout_;
  std::vector<int> children_;
  std::vector<dense::Run> runs_;
  std::vector<int> relative_;
  std::vector<Entry> entries_;
  std::vector<std::vector<int>> subtree_;  // by subtree: its fronts; the last entry has those above
  std::vector<int> subtree_of_;
  bool is_sequential_ = false;   // true: the places of updates are planned for one thread
  bool solves_forward_ = false;  // the present factorisation solves a right-hand side too
  dense::BigArray L_, updates_;
  std::vector<double> inverse_, least_, shift_;
  Workspace own_;  // of the right-hand side that is solved on all threads
};

}  // namespace slom
