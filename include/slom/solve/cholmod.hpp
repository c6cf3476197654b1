/// CHOLMOD as the linear solver, for comparison and where it is trusted. Optional, because its supernodal part is under
/// the GPL: configure with -DSLOM_WITH_CHOLMOD=ON.
#pragma once

#include "slom/model/pimpl.hpp"
#include "slom/solve/linear_solver.hpp"

namespace slom {

/// Sparse Cholesky decomposition of J^T J in scalars, simplicial or supernodal by CHOLMOD's own choice.
///   source   Chen, Davis, Hager and Rajamanickam, "Algorithm 887: CHOLMOD", 2008
class Cholmod final : public LinearSolver {
 public:
  /// Throws [slom.no-cholmod] in a build without it.
  Cholmod();
  ~Cholmod() override;
  void analyze(const BlockStructure& structure) override;
  void beginLinearization() override;
  void add(const JacobianBatch& batch) override;
  void endLinearization() override;
  SolveStatus solve(const Eigen::VectorXd& damping, Eigen::VectorXd& step) override;
  const Eigen::VectorXd& gradient() const override;
  const Eigen::VectorXd& diagonal() const override;
  double squaredNormOfJd(const Eigen::VectorXd& d) const override;
  SolveStatus solveFor(const Eigen::MatrixXd& B, Eigen::MatrixXd& X) override;
  double leastOfColumn() const override;
  std::string description() const override;

  static bool isAvailable();

 private:
  struct Implementation;
  detail::Pimpl<Implementation> impl_;
};

}  // namespace slom
