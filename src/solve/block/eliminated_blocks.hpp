/// The small blocks that are eliminated first, each by itself, and the solution for them.
///
/// H has these blocks first. Each is a column of its diagonal block V_e and the blocks W below it.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "block_lower.hpp"
#include "slom/solve/linear_solver.hpp"

namespace slom {

class EliminatedBlocks {
 public:
  void analyze(const BlockLower& H, int count);
  int count() const { return count_; }

  struct Failure {
    int e = -1, component = -1;
    double ratio = 0;
    bool happened() const { return e >= 0; }
  };
  /// Factorises V_e + damping = L L^T for e in [first, last), up to the first that fails. A block fails if a pivot
  /// falls below the fraction `tolerance` of its diagonal entry. Vectors are by unknown; offset: first unknown of each
  /// position of H.
  Failure factorize(const BlockLower& H, int first, int last, const std::vector<int>& offset,
                    const Eigen::VectorXd& damping, double tolerance);
  SolveStatus factorizeAll(const BlockLower& H, const std::vector<int>& offset,
                           const Eigen::VectorXd& damping, double tolerance);
  /// Computes b := L^-1 b.
  void forward(int e, int d, double* b) const;
  /// Computes b := L^-T b.
  void backward(int e, int d, double* b) const;

  /// Computes b_c -= W V^-1 b_e, in place.
  void reduceVector(const BlockLower& H, const std::vector<int>& offset, Eigen::VectorXd& b) const;
  /// Computes x_e := V^-1 (b_e - W^T x_c), in place; x holds b_e and x_c.
  void substitute(const BlockLower& H, const std::vector<int>& offset, Eigen::VectorXd& x) const;

  /// Writes the blocks of the whole inverse in column e of H into `inverse`: -Z W V^-1 below the diagonal, and V^-1 +
  /// V^-1 W^T Z W V^-1 on it. Z is the inverse of the reduced system. It must have all blocks for pairs of neighbours
  /// of e.
  void invert(const BlockLower& H, int e, const BlockLower& Z, BlockLower& inverse) const;

  /// Returns the factor: lower triangular, column-major, with inverse diagonal.
  const double* factor(int e) const { return factors_.data() + start_[static_cast<std::size_t>(e)]; }

  static SolveStatus status(const Failure& failure, const std::vector<int>& offset);

 private:
  int count_ = 0;
  std::vector<std::size_t> start_;  // first entry of each factor
  std::vector<double> factors_;
};

}  // namespace slom
