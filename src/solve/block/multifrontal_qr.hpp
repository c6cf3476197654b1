/// J = Q R by the multifrontal method. Each front gathers the rows that begin in its columns and the rows left by its
/// children. It triangularises them by Householder reflections and passes on the rows below its own pivots.
///   source   Davis, "Algorithm 915, SuiteSparseQR: Multifrontal multithreaded rank-revealing sparse QR factorization",
///            2011
#pragma once

#include <vector>

#include <Eigen/Core>

#include "jacobian_rows.hpp"
#include "slom/solve/linear_solver.hpp"
#include "solve/symbolic/supernodes.hpp"

namespace slom {

class MultifrontalQR {
 public:
  /// Plans the factorisation. `fronts`: those of the graph of this structure, which must outlive this object.
  void analyze(const BlockStructure& structure, Fronts fronts);

  /// Factorises J diag(scale) with the rows sqrt(damping) below (may be empty), and -r beside it; scale and damping are
  /// by unknown. Stops at a pivot below `tolerance`: columns should have length 1.
  SolveStatus factorize(const JacobianRows& rows, const Eigen::VectorXd& scale,
                        const Eigen::VectorXd& damping, double tolerance);
  /// Returns the x, by unknown, with R x = Q^T (-r).
  Eigen::VectorXd solve() const;
  /// Returns R^-1 R^-T b.
  Eigen::VectorXd solveNormal(const Eigen::VectorXd& b) const;
  const Fronts& fronts() const { return fronts_; }

 private:
  class Panel;
  struct Measurement {
    std::size_t group;
    int index;
  };
  int columnIn(int f, int position) const;
  SolveStatus factorizeFront(int f, const JacobianRows& rows, const Eigen::VectorXd& scale,
                             const Eigen::VectorXd& damping, double tolerance);

  const BlockStructure* structure_ = nullptr;
  Fronts fronts_;
  std::vector<int> row_column_;            // for each entry of Fronts::row, its first column in the front
  std::vector<std::vector<int>> unknown_;  // unknowns of the columns of each front
  std::vector<std::vector<Measurement>> measurements_;  // measurements that begin in each front
  std::vector<std::vector<int>> children_, levels_;  // the fronts of a level need those of the levels before
  std::vector<Eigen::MatrixXd> R_;                   // p x (p + u + 1), the right-hand side last
  std::vector<Eigen::MatrixXd> rest_;                // k x (u + 1), for the parent
};

}  // namespace slom
