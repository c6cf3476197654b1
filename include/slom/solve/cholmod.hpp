/// Cholmod: CHOLMOD as the linear solver, for comparison or if you prefer it. It is optional, because its supernodal
/// part is under the GPL. Configure with -DSLOM_WITH_CHOLMOD=ON.
#pragma once

#include "slom/solve/forwarding_solver.hpp"

namespace slom {

/// Solves by a sparse Cholesky decomposition of J^T J in scalars. CHOLMOD chooses simplicial or supernodal.
///   source   Chen, Davis, Hager and Rajamanickam, "Algorithm 887: CHOLMOD", 2008
class Cholmod final : public ForwardingSolver {
 public:
  /// Creates the solver. Throws [slom.no-cholmod] if this build has no CHOLMOD.
  Cholmod();
  /// Returns whether this build has CHOLMOD.
  static bool isAvailable();
  std::unique_ptr<LinearSolver> makeAnother() const override;
};

}  // namespace slom
