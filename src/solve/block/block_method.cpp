#include "block_method.hpp"

namespace slom {

SolveStatus BlockMethod::prepare(const Eigen::VectorXd& damping, Eigen::VectorXd* x) {
  const bool is_undamped = damping.size() == 0;
  is_forward_solved_ = false;
  if (is_undamped && has_undamped_) return undamped_status_;
  ++preparations_;
  const SolveStatus status = factorize(damping, x);
  is_forward_solved_ = isExact() && x != nullptr;
  has_undamped_ = is_undamped;
  if (is_undamped) undamped_status_ = status;
  return status;
}

SolveStatus BlockMethod::solveColumns(Eigen::MatrixXd& X) {
  SolveStatus status;
  Eigen::VectorXd x;
  for (Eigen::Index j = 0; status.ok && j < X.cols(); ++j) {
    x = X.col(j);
    status = solve(x);
    X.col(j) = x;
  }
  return status;
}

}  // namespace slom
