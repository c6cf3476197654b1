/// Krylov: PETSc's matrix and solver for the sums of a BlockAssembly.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "distributed/block_assembly.hpp"
#include "distributed/system_matrix.hpp"
#include "slom/distributed/petsc_solver.hpp"

namespace slom::distributed {

/// The outcome of a preparation.
struct Prepared {
  bool ok = true;
  std::int64_t unknown =
      -1;  ///< without a unique solution: an unknown that moves, numbered across all processes
};

class Krylov {
 public:
  using Product = SystemMatrix::Product;

  explicit Krylov(const PetscSolverOptions& options);
  ~Krylov();

  /// Returns whether the matrix is asked for as products alone (true) or in blocks (false), by the method or by the
  /// option -slom_matrix; none: choose. Throws [slom.petsc-option].
  std::optional<bool> wantsProducts() const;
  /// Makes the matrix for own rows first ... first + count - 1. `block_size`: of all blocks; 1: they differ. The solver
  /// keeps `product`. If there is one, `blocks` has the diagonal blocks alone, for the preconditioner.
  void plan(const BlockAssembly& blocks, std::int64_t first, int count, int block_size, Product product);
  /// Takes the numbers of the matrix and prepares solutions. The diagonal should be 1. `motions` gives vectors of own
  /// rows that the matrix nearly maps to 0, for multigrid.
  Prepared prepare(const BlockAssembly& blocks, const std::function<Eigen::MatrixXd()>& motions);
  /// Solves for a step to a tolerance, in own rows and in place. A solution outside the tolerance is enough: it leads
  /// downhill. Returns false if there is no solution.
  bool solveStep(Eigen::VectorXd& x, double tolerance);
  /// Solves in own rows and in place. The tolerance is PetscSolverOptions::tolerance / 100. Returns false if conjugate
  /// gradients do not reach it.
  bool solve(Eigen::VectorXd& x);

  bool isExact() const;
  std::string description() const;
  long iterations() const;

 private:
  bool solveTo(Eigen::VectorXd& x, double tolerance, bool is_step);
  struct Implementation;
  std::unique_ptr<Implementation> own_;
};

}  // namespace slom::distributed
