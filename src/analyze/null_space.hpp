/// The near-null space of J: directions in which the unknowns can move without changing the residuals, or hardly.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "analyze/linearized_problem.hpp"

namespace slom {

/// Unknowns are scaled by the lengths of their columns of J, so that units do not matter.
struct NearNullSpace {
  Eigen::VectorXd scale;        ///< |J_i|, by unknown; 1 where it is 0
  std::vector<int> unobserved;  ///< unobservable unknowns, whose column is 0; `direction` is 0 there
  Eigen::MatrixXd
      direction;  ///< unknowns x count, orthonormal, in scaled unknowns: d_i = direction(i, k) / scale[i]
  Eigen::VectorXd influence;   ///< |J d| of each direction, ascending
  bool may_miss_some = false;  ///< the null space may have more directions than the search takes

  /// Number of directions whose influence is below `limit`.
  Eigen::Index countBelow(double limit) const { return (influence.array() < limit).count(); }
  /// Dimension of the null space of J: directions with |J d| below `limit`, and unobservable unknowns.
  int dimension(double limit) const {
    return static_cast<int>(countBelow(limit)) + static_cast<int>(unobserved.size());
  }
};

/// Below this |J d| of a direction, in scaled unknowns, a hint is due.
inline constexpr double kNearNull = 1e-6;

/// Finds at least the directions with |J d| below `limit`, by inverse iteration with the factor of J^T J or, where that has no
/// full rank, of J^T J + tiny damping; |J d| itself is computed from J, so that it does not suffer from the squared condition number.
///   source   Golub and Van Loan, "Matrix computations", 2013, section 8.2 (subspace iteration)
NearNullSpace findNearNullSpace(const LinearizedProblem& linearized, double limit);

}  // namespace slom
