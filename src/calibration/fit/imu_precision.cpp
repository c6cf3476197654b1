#include "calibration/fit/imu_precision.hpp"

#include <cmath>

#include <Eigen/Cholesky>

namespace slom::calibration {

Eigen::MatrixXd whenKnown(const Eigen::MatrixXd& covariance, int first, int count) {
  const auto known_columns = covariance.middleCols(first, count);
  const Eigen::MatrixXd known = covariance.block(first, first, count, count);
  Eigen::MatrixXd rest = covariance - known_columns * known.ldlt().solve(known_columns.transpose());
  rest.middleCols(first, count).setZero();  // exactly 0; rounding left a trace
  rest.middleRows(first, count).setZero();
  return rest;
}

ImuPrecision precisionOf(const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd std = covariance.diagonal().cwiseMax(0).cwiseSqrt();
  return {std.head<3>().maxCoeff(), std.segment<3>(3).maxCoeff(), std[6]};
}

}  // namespace slom::calibration
