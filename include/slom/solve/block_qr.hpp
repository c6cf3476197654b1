/// The square-root path: a sparse QR decomposition of the Jacobian, for ill-conditioned problems.
#pragma once

#include "slom/solve/forwarding_solver.hpp"

namespace slom {

/// Minimises |r + J d|^2 + sum_i damping_i d_i^2 by J = Q R, without J^T J: the condition number is not squared, so that
/// twice as many digits are left of what the data determine weakly. It takes several times as long as a BlockSolver.
class BlockQR final : public ForwardingSolver {
 public:
  /// The rank runs out where less than this share is left of the length of a column.
  static constexpr double kPivotTolerance = 1e-12;
  /// `pivot_tolerance`: share of the length of a column that must be left of it.
  explicit BlockQR(double pivot_tolerance = kPivotTolerance);
  std::unique_ptr<LinearSolver> makeAnother() const override;
};

}  // namespace slom
