// Uncertainties from a joint covariance of the IMU's parameters. Order: rotation 3, acc_bias 3, gravity 1.
#pragma once

#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// Returns the covariance of all parameters if `count` parameters, from `first` on, were known: 0 for these, smaller
/// for the others.
Eigen::MatrixXd whenKnown(const Eigen::MatrixXd& covariance, int first, int count);

/// Returns the largest standard deviation of each parameter.
ImuPrecision precisionOf(const Eigen::MatrixXd& covariance);

}  // namespace slom::calibration
