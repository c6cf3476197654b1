/// BlockQR: a sparse QR decomposition of the Jacobian, for ill-conditioned problems.
#pragma once

#include "slom/solve/forwarding_solver.hpp"

namespace slom {

/// Minimises |r + J d|^2 + sum_i damping_i d_i^2 by J = Q R, without J^T J. The condition number is not squared, so
/// weakly determined unknowns keep twice as many digits. Takes several times as long as a BlockSolver.
class BlockQR final : public ForwardingSolver {
 public:
  /// Default of the pivot tolerance. J has no full rank if less than this fraction of the length of a column remains.
  static constexpr double kPivotTolerance = 1e-12;
  /// Sets the fraction of the length of a column that must remain.
  explicit BlockQR(double pivot_tolerance = kPivotTolerance);
  std::unique_ptr<LinearSolver> makeAnother() const override;
};

}  // namespace slom
