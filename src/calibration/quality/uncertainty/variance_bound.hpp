// Lower bounds of variances that need no large factorization. They show for most candidates for a further image that
// the candidate does not help enough.
//
// A number that changes by a ds + e dm has the variance
//   b C b^T + y^T N y,   y = G^-1 e^T,   b = a + y^T F,   C = (sum Lambda)^-1
// and for any x, b C b^T >= (b x)^2 / (x^T (sum Lambda) x), with equality for x = C b^T (Cauchy and Schwarz). The
// letters are those of information.hpp.
#pragma once

#include "calibration/quality/uncertainty/information.hpp"

namespace slom::calibration {

class VarianceBound {
 public:
  /// Prepares the bound for a number with rows a (`by_shared`) and e (`by_motion`). The bound is close to the
  /// variance for images that determine the parameters about as well as `posterior`.
  VarianceBound(const Eigen::RowVectorXd& by_shared, const Eigen::Matrix<double, 1, 6>& by_motion,
                const Posterior& posterior);
  /// Returns the bound of the variance given these images.
  double of(const Information& images) const;

 private:
  Eigen::VectorXd trial_;  // x
  double along_ = 0;       // a x
  Eigen::Matrix<double, 6, 1> by_motion_;
};

}  // namespace slom::calibration
