/// The near-null space of J: directions in which the unknowns can move while the residuals hardly change.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "analyze/linearized_problem.hpp"

namespace slom {

/// Directions in scaled unknowns. The scale of an unknown is the length of its column of J, so units do not matter.
struct NearNullSpace {
  Eigen::VectorXd scale;        ///< J_i|, by unknown; 1 if that is 0
  std::vector<int> unobserved;  ///< unobservable unknowns: column and entries in `direction` are 0
  Eigen::MatrixXd
      direction;  ///< unknowns x count, orthonormal, in scaled unknowns: d_i = direction(i, k) / scale[i]
  Eigen::VectorXd influence;   ///< |J d| of each direction, ascending
  bool may_miss_some = false;  ///< the null space may have more directions than the search takes

  /// Returns the number of directions with an influence below `limit`.
  Eigen::Index countBelow(double limit) const { return (influence.array() < limit).count(); }
  /// Returns the dimension of the null space of J: directions with |J d| below `limit`, plus unobservable unknowns.
  int dimension(double limit) const {
    return static_cast<int>(countBelow(limit)) + static_cast<int>(unobserved.size());
  }
};

/// Influence |J d| of a direction, in scaled unknowns, below which a hint is given.
inline constexpr double kNearNull = 1e-6;

/// Finds at least the directions with |J d| below `limit`, by inverse iteration. It uses the factor of J^T J, or of J^T
/// J + tiny damping if J^T J has no full rank. |J d| is computed from J itself, so it does not suffer from the squared
/// condition number.
///   source   Golub and Van Loan, "Matrix computations", 2013, section 8.2 (subspace iteration)
NearNullSpace findNearNullSpace(const LinearizedProblem& linearized, double limit);

}  // namespace slom
