/// The reduced system S = H_cc + damping - W (V + damping)^-1 W^T without its blocks: products with S, and
/// preconditioners. If nothing is eliminated, S is H + damping.
///   source   Agarwal, Snavely, Seitz and Szeliski, "Bundle adjustment in the large", 2010, section 3;
///            Weber, Demmel, Chan and Cremers, "Power bundle adjustment for large-scale 3D reconstruction", 2023
#pragma once

#include <vector>

#include <Eigen/Core>

#include "eliminated_blocks.hpp"
#include "slom/solve/block_solver.hpp"

namespace slom {

/// The operator. Vectors of the reduced system have the unknowns of the remaining blocks, by their position in H.
class ReducedOperator {
 public:
  using Preconditioner = BlockSolverOptions::Preconditioner;

  /// Prepares the structure. The first `eliminated` columns of H are eliminated.
  void analyze(const BlockLower& H, int eliminated, Preconditioner preconditioner);
  /// Returns the preconditioner in use: schur_jacobi if the power series might diverge.
  Preconditioner preconditioner() const { return preconditioner_; }
  int size() const { return start_.back(); }
  const EliminatedBlocks& eliminated() const { return eliminated_; }

  /// Prepares products with these numbers of H, which must not change until the last product. Vectors are by unknown;
  /// offset: first unknown of each position of H. Stops at a pivot below the fraction `tolerance` of its diagonal
  /// entry.
  SolveStatus prepare(const BlockLower& H, const std::vector<int>& offset, const Eigen::VectorXd& damping,
                      double tolerance);
  /// Prepares products alone, without the preconditioner.
  SolveStatus prepareProducts(const BlockLower& H, const std::vector<int>& offset,
                              const Eigen::VectorXd& damping, double tolerance);
  /// Returns the block of remaining block c that the preconditioner inverts: for schur_jacobi, that of S.
  Eigen::MatrixXd diagonalBlock(int c) const;
  /// Computes y := S x.
  void multiply(const Eigen::VectorXd& x, Eigen::VectorXd& y);
  /// Computes z := M^-1 r with an M close to S.
  void precondition(const Eigen::VectorXd& r, Eigen::VectorXd& z);

  Eigen::VectorXd reducedOf(const Eigen::VectorXd& full, const std::vector<int>& offset) const;
  void putInto(const Eigen::VectorXd& reduced, const std::vector<int>& offset, Eigen::VectorXd& full) const;

 private:
  struct Neighbour {
    int block, column;  // block of H left of the diagonal, and its column
  };
  int dof(int c) const {
    return start_[static_cast<std::size_t>(c) + 1] - start_[static_cast<std::size_t>(c)];
  }
  int left() const { return static_cast<int>(start_.size()) - 1; }
  void prepareRow(int c);
  void applyDiagonal(const Eigen::VectorXd& r, Eigen::VectorXd& z) const;

  const BlockLower* H_ = nullptr;
  Preconditioner preconditioner_ = Preconditioner::schur_jacobi;
  EliminatedBlocks eliminated_;
  std::vector<int> start_;                     // first unknown of each remaining block
  std::vector<int> first_;                     // first neighbour of each remaining block
  std::vector<Neighbour> neighbours_;          // in its row of H
  std::vector<std::size_t> eliminated_start_;  // start of each eliminated block in images_
  std::vector<double> images_;                 // -V^-1 W^T x
  std::vector<Eigen::MatrixXd> diagonal_;      // diagonal blocks of H_cc + damping
  std::vector<Eigen::MatrixXd> inverse_;       // inverses of the preconditioner's diagonal blocks
  Eigen::VectorXd term_, image_;
};

/// Outcome of conjugate gradients.
struct ConjugateGradientsOutcome {
  int iterations = 0;
  bool ok = true;             ///< false: S is not positive definite
  bool has_converged = true;  ///< false also if iterations ended before the tolerance was reached
};

/// Solves S x = b from x = 0, until |b - S x|_(M^-1) <= tolerance |b|_(M^-1).
///   source   Hestenes and Stiefel, "Methods of conjugate gradients for solving linear systems", 1952
ConjugateGradientsOutcome conjugateGradients(ReducedOperator& S, const Eigen::VectorXd& b, double tolerance,
                                             int max_iterations, Eigen::VectorXd& x);

}  // namespace slom
