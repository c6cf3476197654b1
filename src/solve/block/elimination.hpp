/// Blocks that are eliminated before the others are ordered and put into fronts, and what they leave: the reduced system S.
///
/// H has them first, in their order. In its layout the blocks of S follow them, in the order that they have in S.
/// Vectors are by unknown; `offset` is the first unknown of each position of H.
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
  /// How many blocks.
  virtual int count() const = 0;
  /// What the description of the system does not say; may be empty.
  virtual std::string description() const = 0;
  /// Operations, additions and multiplications.
  virtual double flops() const = 0;
  virtual const BlockLower& S() const = 0;

  /// Factorises the eliminated columns of H + damping and makes S, without damping. A pivot below the share `tolerance` of
  /// its diagonal entry of H + damping ends it. x, where given, goes through `forward` on the way.
  virtual SolveStatus reduce(const BlockLower& H, const std::vector<int>& offset,
                             const Eigen::VectorXd& damping, double tolerance, Eigen::VectorXd* x) = 0;
  /// Makes of a right-hand side x that of S, in place, and for the eliminated blocks what `substitute` takes.
  virtual void forward(const BlockLower& H, const std::vector<int>& offset, Eigen::VectorXd& x) const = 0;
  /// x_e for the eliminated blocks, when x has the solution for the others.
  virtual void substitute(const BlockLower& H, const std::vector<int>& offset, Eigen::VectorXd& x) const = 0;
  /// The blocks of the whole inverse in the eliminated columns, into `inverse`, laid out as H; Z: those of the inverse of S,
  /// laid out as that.
  virtual void invert(const BlockLower& H, const BlockLower& Z, BlockLower& inverse) const = 0;
};

}  // namespace slom
