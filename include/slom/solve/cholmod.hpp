/// CHOLMOD as the linear solver, for comparison and where it is trusted. Optional, because its supernodal part is under
/// the GPL: configure with -DSLOM_WITH_CHOLMOD=ON.
#pragma once

#include "slom/solve/forwarding_solver.hpp"

namespace slom {

/// Sparse Cholesky decomposition of J^T J in scalars, simplicial or supernodal by CHOLMOD's own choice.
///   source   Chen, Davis, Hager and Rajamanickam, "Algorithm 887: CHOLMOD", 2008
class Cholmod final : public ForwardingSolver {
 public:
  /// Throws [slom.no-cholmod] in a build without it.
  Cholmod();
  /// Whether this build has it.
  static bool isAvailable();
  std::unique_ptr<LinearSolver> makeAnother() const override;
};

}  // namespace slom
