/// Blocks that are eliminated before the others are ordered and put into fronts, and the reduced system S of the
/// others.
///
/// H has the eliminated blocks first, in their order. The blocks of S follow in the order that they have in S. Vectors
/// are by unknown; `offset` is the first unknown of each position of H.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "block_lower.hpp"
#include "slom/solve/linear_solver.hpp"

namespace slom {

class Elimination {
 public:
  virtual ~Elimination() = default;
  /// Returns the number of eliminated blocks.
  virtual int count() const = 0;
  /// Returns what the description of the system does not contain; may be empty.
  virtual std::string description() const = 0;
  /// Returns the number of additions and multiplications.
  virtual double flops() const = 0;
  virtual const BlockLower& S() const = 0;

  /// Factorises the eliminated columns of H + damping and computes S, without damping. Stops at a pivot below the
  /// fraction `tolerance` of its diagonal entry of H + damping. x, if given, is passed through `forward` at the same
  /// time.
  virtual SolveStatus reduce(const BlockLower& H, const std::vector<int>& offset,
                             const Eigen::VectorXd& damping, double tolerance, Eigen::VectorXd* x) = 0;
  /// Turns a right-hand side x into that of S, in place. For the eliminated blocks, leaves what `substitute` needs.
  virtual void forward(const BlockLower& H, const std::vector<int>& offset, Eigen::VectorXd& x) const = 0;
  /// Computes x_e for the eliminated blocks; x holds the solution for the others.
  virtual void substitute(const BlockLower& H, const std::vector<int>& offset, Eigen::VectorXd& x) const = 0;
  /// Writes the blocks of the whole inverse in the eliminated columns into `inverse`, which is laid out as H. Z: the
  /// inverse of S, laid out as S.
  virtual void invert(const BlockLower& H, const BlockLower& Z, BlockLower& inverse) const = 0;
};

}  // namespace slom
