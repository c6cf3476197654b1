#include "calibration/quality/uncertainty/variance_bound.hpp"

namespace slom::calibration {
namespace {

/// Returns x^T A x of a symmetric matrix, from its lower triangle.
double quadraticForm(const Eigen::MatrixXd& A, const Eigen::VectorXd& x) {
  double sum = 0;
  for (Eigen::Index j = 0; j < x.size(); ++j) {
    const Eigen::Index below = x.size() - j - 1;
    sum += x[j] * (A(j, j) * x[j] + 2 * A.col(j).tail(below).dot(x.tail(below)));
  }
  return sum;
}

}  // namespace

VarianceBound::VarianceBound(const Eigen::RowVectorXd& by_shared,
                             const Eigen::Matrix<double, 1, 6>& by_motion, const Posterior& posterior)
    : by_motion_(by_motion.transpose()) {
  const Eigen::VectorXd a = by_shared(posterior.free_).transpose();
  trial_ = posterior.solve(a + posterior.motion_by_shared_.transpose() * by_motion_);
  along_ = trial_.dot(a);
}

double VarianceBound::of(const Information& images) const {
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  const Vector6 y = images.motion_.llt().solve(by_motion_);
  const Vector6 by_trial = images.motion_shared_ * trial_;
  const double along = along_ + y.dot(by_trial);
  const double bound = along * along / quadraticForm(images.shared_, trial_) + y.dot(images.noise_ * y);
  return bound > 0 ? bound : 0;  // NaN without free parameters
}

}  // namespace slom::calibration
