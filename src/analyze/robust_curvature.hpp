/// How the curvature of a robust cost differs from the H by which it is fitted.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "analyze/linearized_problem.hpp"

namespace slom {

/// Where a loss is nearly or truly concave along the residual, H counts the measurement by its weight alone (src/linearize/reweight.hpp), and
/// so more than the cost curves: the Hessian of the cost is H - E, E = sum 2 |rho''| J^T r r^T J over those measurements. By how much an
/// estimate follows its data is (H - E)^-1, which a sandwich has to take.
///   source   Huber and Ronchetti, "Robust statistics", 2009, sections 3.2 and 7.6
class RobustCurvature {
 public:
  explicit RobustCurvature(const LinearizedProblem& linearized);

  /// Whether E is 0.
  bool isZero() const { return terms_.empty(); }
  /// (H - E)^-1 B for Z = H^-1 B; false, with Z as it was, where the cost is not convex enough for that.
  bool correct(FreeGauge gauge, Eigen::MatrixXd& Z) const;

 private:
  struct Term {
    std::size_t pool;
    int measurement;
    double curvature;  // 2 |rho''|
  };
  Eigen::MatrixXd times(const Eigen::MatrixXd& X) const;

  const LinearizedProblem& linearized_;
  std::vector<Term> terms_;
};

}  // namespace slom
