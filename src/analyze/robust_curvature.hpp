/// Difference between the curvature of a robust cost and the H with which the cost is fitted.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "analyze/linearized_problem.hpp"

namespace slom {

/// The correction E of H. If a loss is concave or nearly concave along the residual, H counts the measurement by its
/// weight alone (src/linearize/reweight.hpp), which is more than the curvature of the cost. The Hessian of the cost is
/// H - E with E = sum 2 |rho''| J^T r r^T J over those measurements. An estimate follows its data by (H - E)^-1, so
/// sandwich covariances need it.
///   source   Huber and Ronchetti, "Robust statistics", 2009, sections 3.2 and 7.6
class RobustCurvature {
 public:
  explicit RobustCurvature(const LinearizedProblem& linearized);

  /// Returns whether E is 0.
  bool isZero() const { return terms_.empty(); }
  /// Replaces Z = H^-1 B by (H - E)^-1 B. If the cost is not convex enough for that, returns false and leaves Z
  /// unchanged.
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
