/// PetscSolver: the linear solver for problems whose parts are in several processes, by PETSc.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "slom/estimator.hpp"

namespace slom::distributed {

/// Variables that several processes have. Each process inserts a shared variable into its own estimator, with the same
/// start value and the same fixed components, and names it here. A variable without a name belongs to one process.
class SharedVariables {
 public:
  /// Names the variable; all processes that have it give the same name. `is_home`: the variable belongs here if this
  /// process has measurements of it. Without any home, the first process with measurements takes it.
  template <AnyVariableHandle V>
  void share(const Estimator& est, const V& id, std::uint64_t name, bool is_home = false) {
    entries_.push_back({est.table().indexOf(id), name, is_home});
  }

  /// A variable with its name.
  struct Entry {
    int variable = 0;  ///< index in the table of the problem
    std::uint64_t name = 0;
    bool is_home = false;
  };
  /// Returns the variables in the order in which they were named.
  const std::vector<Entry>& entries() const { return entries_; }

 private:
  std::vector<Entry> entries_;
};

/// Method of the solution of the system that remains after small independent blocks (points) are eliminated in each
/// process. PETSc's options (-ksp_type, -pc_type, ...) replace it; -slom_matrix free or assembled replaces the choice
/// of matrix_free. Throws [slom.petsc-option] in the fit for another form.
enum class PetscMethod {
  automatic,  ///< by the number of remaining unknowns: cholesky, block_jacobi, multigrid; matrix_free if the
              ///< remaining system would take more than 4 GB in a process
  cholesky,   ///< exact, by MUMPS; detects a loss of rank; bits may differ between runs
  jacobi,     ///< conjugate gradients with the diagonal blocks of variables
  block_jacobi,  ///< conjugate gradients with an incomplete factorisation in each process
  schwarz,       ///< conjugate gradients with overlapping parts
  multigrid,     ///< conjugate gradients with GAMG, whose near-null space are the motions of the world
  matrix_free,   ///< conjugate gradients by products alone, in the memory of the measurements' blocks
};

/// Options of a PetscSolver.
struct PetscSolverOptions {
  PetscMethod method = PetscMethod::automatic;
  /// Tolerance of conjugate gradients: norm of the residual, relative to the right-hand side. A step has the tolerance
  /// min(forcing, sqrt(|g| / largest |g| so far)), as BlockSolverOptions::forcing, but at least `tolerance`. So the first
  /// steps are rough and the last ones exact. PETSc's option -ksp_rtol replaces this for all steps.
  double forcing = 0.1;
  double tolerance = 1e-11;
  int max_iterations = 20000;  ///< of conjugate gradients in each step
};

/// Solves (J^T J + damping) d = -J^T r for the measurements of all processes. Each process has an Estimator with its own
/// measurements and the variables that they depend on:
///
///     slom::distributed::SharedVariables shared;
///     shared.share(est, pose, 17);
///     est.changeSolver(std::make_unique<slom::distributed::PetscSolver>(est, shared));
///     const slom::Summary summary = est.optimize();  // in all processes; the same summary in each
///
/// Fixed components work as in a single process; shared variables may not have bounds. With this solver, the analyses
/// of the estimator throw [slom.needs-all]. Throws [slom.bad-share] in the fit, if processes disagree on a variable.
class PetscSolver final : public LinearSolver {
 public:
  /// Refers to the problem of the estimator, which must outlive the solver; Estimator::changeSolver sees to that.
  explicit PetscSolver(const Estimator& est, SharedVariables shared = {},
                       const PetscSolverOptions& options = {});
  ~PetscSolver() override;

  void analyze(const BlockStructure& structure) override;
  void beginLinearization() override;
  void add(const JacobianBatch& batch) override;
  std::span<const MeasurementPlace> partitions() const override;
  void endLinearization() override;
  void completeLinearization() override;
  const Collective& collective() const override;
  SolveStatus solve(const Eigen::VectorXd& damping, Eigen::VectorXd& step) override;
  bool isExact() const override;
  const Eigen::VectorXd& gradient() const override;
  const Eigen::VectorXd& diagonal() const override;
  double squaredNormOfJd(const Eigen::VectorXd& d) const override;
  /// As LinearSolver::solveFor, in all processes with the same number of columns. Entries of B that several processes
  /// have for a shared variable are added. Covariances uses it.
  SolveStatus solveFor(const Eigen::MatrixXd& B, Eigen::MatrixXd& X) override;
  std::string description() const override;

  /// Returns whether the variable belongs to this process, after the first fit. Every optimised variable with
  /// measurements belongs to one process.
  template <AnyVariableHandle V>
  bool isOwn(const V& id) const {
    return collective().counts(table().indexOf(id));
  }
  /// Returns whether the variable has unknowns here: it is optimised, and measurements here depend on it.
  template <AnyVariableHandle V>
  bool hasUnknowns(const V& id) const {
    return hasUnknowns(table().indexOf(id));
  }
  /// Returns the iterations of conjugate gradients since construction.
  long iterations() const;

 private:
  const Problem& table() const;
  bool hasUnknowns(int variable) const;
  struct Implementation;
  std::unique_ptr<Implementation> own_;
};

}  // namespace slom::distributed
