/// The reduced system S = H_cc + damping - W (V + damping)^-1 W^T without its blocks: products with it, and
/// preconditioners. With nothing eliminated it is H + damping.
///   source   Agarwal, Snavely, Seitz and Szeliski, "Bundle adjustment in the large", 2010, section 3;
///            Weber, Demmel, Chan and Cremers, "Power bundle adjustment for large-scale 3D reconstruction", 2023
#pragma once

#include <vector>

#include <Eigen/Core>

#include "eliminated_blocks.hpp"
#include "slom/solve/block_solver.hpp"

namespace slom {

/// Vectors of the reduced system have the unknowns of the blocks that are left, by their position in H.
class ReducedOperator {
 public:
  using Preconditioner = BlockSolverOptions::Preconditioner;

  /// The first `eliminated` columns of H are eliminated.
  void analyze(const BlockLower& H, int eliminated, Preconditioner preconditioner);
  /// What is used, which is schur_jacobi where the power series might diverge.
  Preconditioner preconditioner() const { return preconditioner_; }
  int size() const { return start_.back(); }
  const EliminatedBlocks& eliminated() const { return eliminated_; }

  /// Prepares products for these numbers of H, which must stay as they are until the last one. Vectors by unknown; offset: first
  /// unknown of each position of H. A pivot below the share `tolerance` of its diagonal entry ends it.
  SolveStatus prepare(const BlockLower& H, const std::vector<int>& offset, const Eigen::VectorXd& damping,
                      double tolerance);
  /// y := S x
  void multiply(const Eigen::VectorXd& x, Eigen::VectorXd& y);
  /// z := M^-1 r with an M near S.
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
  void prepareRow(int c, const std::vector<int>& offset, const Eigen::VectorXd& damping);
  void applyDiagonal(const Eigen::VectorXd& r, Eigen::VectorXd& z) const;

  const BlockLower* H_ = nullptr;
  Preconditioner preconditioner_ = Preconditioner::schur_jacobi;
  EliminatedBlocks eliminated_;
  std::vector<int> start_;                     // first unknown of each block that is left
  std::vector<int> first_;                     // first neighbour of each block that is left
  std::vector<Neighbour> neighbours_;          // in its row of H
  std::vector<std::size_t> eliminated_start_;  // start of each eliminated block in images_
  std::vector<double> images_;                 // -V^-1 W^T x
  std::vector<Eigen::MatrixXd> diagonal_;      // diagonal blocks of H_cc + damping
  std::vector<Eigen::MatrixXd> inverse_;       // inverses of the preconditioner's diagonal blocks
  Eigen::VectorXd term_, image_;
};

/// What conjugate gradients did.
struct ConjugateGradientsOutcome {
  int iterations = 0;
  bool ok = true;             ///< false when S is not positive definite
  bool has_converged = true;  ///< false as well where the iterations ended before the tolerance was reached
};

/// S x = b, from x = 0, until |b - S x|_(M^-1) <= tolerance |b|_(M^-1).
///   source   Hestenes and Stiefel, "Methods of conjugate gradients for solving linear systems", 1952
ConjugateGradientsOutcome conjugateGradients(ReducedOperator& S, const Eigen::VectorXd& b, double tolerance,
                                             int max_iterations, Eigen::VectorXd& x);

}  // namespace slom
