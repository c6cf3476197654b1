/// A Cholesky factorisation that follows its matrix: only what has changed is factorised again.
///
///   matrix     H = sum of A_e^T A_e over elements (linearised measurements), in blocks (variables)
///   gradient   g = sum of g_e
///   factor     for each front (see symbolic/supernodes.hpp) its columns of L and its update matrix, both kept
///   step       d = -H^-1 g; |L^-1 g|^2 = g^T H^-1 g is its predicted decrease of the RSS
///
/// A new or removed element changes the fronts from its first eliminated block up to the root. These fronts are
/// dissolved: their blocks are reordered, the newest last, and the subtrees below are attached again with their update
/// matrices unchanged. An element with other numbers leaves the fronts as they are. Its front and those above it are
/// factorised again. If only the gradient changes, only vectors are passed up the tree.
///   source   Kaess et al., "iSAM2: Incremental smoothing and mapping using the Bayes tree", IJRR 2012 (the affected
///            part is the top of the tree; here with update matrices of a multifrontal Cholesky factorisation instead of
///            QR factors); Liu, "The multifrontal method for sparse matrix solution", 1992
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "base/index.hpp"
#include "solve/dense/big_array.hpp"
#include "solve/dense/child_rows.hpp"
#include "solve/symbolic/supernodes.hpp"

namespace slom {

class IncrementalCholesky {
 public:
  /// Inserts a block without elements.
  void insertBlock(int block, int dof);
  /// Removes a block that no element touches any more.
  void removeBlock(int block);
  int dof(int block) const { return blocks_[at(block)].dof; }

  /// Inserts an element over these blocks, each named once. Its numbers are 0 until they are set. Returns its index.
  int insertElement(std::span<const int> blocks, int rows);
  void removeElement(int element);
  /// Returns the blocks of the element, in the order of the columns of A. A is rows x columns, column-major.
  std::span<const int> blocksOf(int element) const { return elements_[at(element)].blocks; }
  int rowsOf(int element) const { return elements_[at(element)].rows; }
  /// Returns A. This view, and that of the gradient, is valid until another element is inserted.
  std::span<const double> A(int element) const {
    const Element& e = elements_[at(element)];
    return {numbers_.data() + e.start, e.entries()};
  }
  std::span<const double> gradient(int element) const {
    const Element& e = elements_[at(element)];
    return {numbers_.data() + e.start + e.entries(), at(e.columns)};
  }
  double squaredNormOfA(int element) const { return elements_[at(element)].squared_norm; }
  void setA(int element, std::span<const double> A);
  void setGradient(int element, std::span<const double> g);

  /// Work of one call or of all calls.
  struct Work {
    int fronts_factorized = 0, fronts_solved = 0, fronts_inverted = 0, blocks_ordered = 0;
    double flops = 0;
    bool reordered_all = false;
  };
  /// Updates the factor and L^-1 g.
  void refactor();
  /// Returns g^T H^-1 g.
  double promise() const;

  /// Entries of d for one block.
  struct Move {
    int block;
    const double* d;  ///< valid until the next call of any function of this class
  };
  /// Returns the blocks that d moves. Fronts whose own predicted decrease is below `threshold` do not move. Unless
  /// `everywhere` is true, neither do fronts that earlier solutions left.
  const std::vector<Move>& solve(double threshold, bool everywhere = true);

  /// Returns the unknowns (block, component) of all fronts that are undetermined given those eliminated before. They
  /// stay where they are.
  const std::set<std::pair<int, int>>& undetermined() const { return undetermined_; }

  /// Returns the block of H^-1 with the rows of a and the columns of b, column-major. Uses the fronts from b up to the
  /// root, and from there down to a. The factor must be up to date.
  std::vector<double> inverseBlock(int a, int b) const;
  /// Updates the diagonal blocks C of H^-1 from the root downwards. Stops where they have certainly changed by at most
  /// the fraction `most_change` since they were computed: -most_change C <= change <= most_change C in the order of
  /// positive semidefinite matrices. The factor must be up to date and determine everything.
  void updateInverse(double most_change);
  /// Writes the diagonal block of H^-1 of a block, column-major, as updateInverse() left it.
  void writeInverse(int block, double* out) const;
  /// Returns the undetermined unknowns of the fronts from that of the block up to the root.
  std::vector<std::pair<int, int>> undeterminedAbove(int block) const;

  const Work& work() const { return work_; }
  void resetWork() { work_ = {}; }
  int blockCount() const { return static_cast<int>(blocks_.size()); }
  int frontCount() const { return static_cast<int>(fronts_.size() - free_fronts_.size()); }

  /// Factorises everything from scratch in the same order, for comparison.
  void recompute();
  /// Returns all numbers of the factor and of L^-1 g in the order of the fronts, for comparison.
  std::vector<double> content() const;

 private:
  struct Block {
    int dof = 0;              // 0: no such block
    int front = -1;           // the front that eliminates it
    std::uint64_t order = 0;  // rank in the order of elimination
    std::uint64_t age = 0;    // rank in the order of insertion
  };
  struct Element {
    std::vector<int> blocks;  // empty: no such element
    int rows = 0, columns = 0;
    std::size_t start = 0;    // of A in numbers_, and after it g
    double squared_norm = 0;  // of A
    int front = -1;           // the front that assembles it: that of its first eliminated block
    std::vector<std::pair<int, int>> places;  // of its blocks in that front: first row, dof

    std::size_t entries() const { return at(rows) * at(columns); }
  };
  /// A front's part of H^-1.
  struct Inverse {
    Eigen::MatrixXd Z;                // pivots first
    std::uint64_t factorization = 0;  // number of the factorisation it was computed from
    double change_below = 0;          // bound of the changes left in the subtree when Z was computed
    double change = 0;                // bound of the changes since then, including that of Z
    double flops = 0;                 // work of computing the subtree
  };
  struct Front {
    std::vector<int> pivots, rows;  // blocks
    int p = 0, u = 0;
    int parent = -1;
    std::vector<int> children;  // sorted by the order of their first pivots
    std::vector<int> elements;  // ascending
    dense::ChildRows in_parent;
    dense::BigArray D, B, U;
    std::vector<double> inverse, y, below, diagonal_below;
    std::vector<char> undetermined;  // of the pivots; empty: none
    double own_promise = 0, promise_below = 0;
    bool has_factor = false, has_solution = false;
    bool has_news = true;             // news here or below since the last step went down
    std::uint64_t order = 0;          // order of the first pivot
    std::uint64_t factorization = 0;  // number of its last factorisation
    std::unique_ptr<Inverse> inverse_part;
  };
  void touch(int front, bool is_factor);
  void pushDirty(int front);
  std::size_t roomFor(std::size_t count);
  void markPathFrom(int block);
  void dissolve(int front);
  void rebuildTop();
  void reorder();
  BlockGraph looseGraph();
  std::vector<int> makeLooseFronts(const Fronts& shapes);
  int firstOf(const std::vector<int>& blocks) const;
  int newFront();
  void attach(int child, int parent);
  void place(const Front& front);
  static void addRows(const Front& child, const std::vector<double>& from, std::vector<double>& to);
  void forgetUndetermined(int block);
  double* rowOf(Front& front, int row, bool to_panel) const;
  double* entry(Front& front, int row, int column) const;
  void assemblePanel(Front& front, const std::vector<double>& corrections);
  void addElements(Front& front, bool to_panel);
  void addChildren(Front& front, bool to_panel);
  void factorizeFront(int f);
  void solveFront(int f);
  double correctionOf(Front& front, int pivot, double computed, double diagonal);
  double squaredLengthAlong(Front& front, int pivot);
  double squaredLengthOf(const Element& element, const std::vector<double>& x) const;
  void hold(Front& front, int pivot);
  void goDown(int f, double threshold, bool everywhere);
  /// Returns the additions and multiplications of passing one vector through a front.
  static double substitutionFlops(double p, double u) { return p * (p + 2 * u); }
  static Eigen::MatrixXd inverseOfRows(const Front& child, const Eigen::MatrixXd& Z);
  static bool mayStay(Front& front, const Eigen::MatrixXd& rows, double most_change);
  void invertFront(Front& front, const Eigen::MatrixXd& rows);
  std::vector<int> pathFrom(int block) const;
  std::vector<double> inverseColumn(int a, int b, int component) const;

  std::vector<Block> blocks_;
  std::vector<Element> elements_;
  std::vector<int> free_elements_;
  std::vector<double> numbers_;                                   // of elements, contiguous for each
  std::map<std::size_t, std::vector<std::size_t>> free_numbers_;  // by size: free places in numbers_
  std::vector<Front> fronts_;
  std::vector<int> free_fronts_;
  std::set<int> roots_;
  /// Fronts to be factorised or solved, with their order: a heap, children first. Fronts dissolved meanwhile stay in
  /// it.
  std::vector<std::pair<std::uint64_t, int>> dirty_;
  std::set<std::pair<int, int>> undetermined_;
  // Parts of the new top: blocks and elements of dissolved fronts, and the subtrees that were below them.
  std::vector<int> loose_blocks_, loose_elements_, loose_subtrees_;
  std::vector<int> local_;    // place of each block in the current front or graph; -1 outside of it
  std::vector<double> step_;  // entries of d
  std::vector<double> rows_;  // rows of the current front
  std::vector<Move> moves_;
  std::vector<int> to_visit_;
  std::uint64_t next_order_ = 1, next_age_ = 1, factorizations_ = 0;
  double factor_flops_ = 0, flops_when_ordered_ = 0;
  std::size_t filled_blocks_ = 0, blocks_when_ordered_ = 0;
  Work work_;
};

}  // namespace slom
