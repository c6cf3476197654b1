// What a joint covariance of the IMU's parameters says about them. Order: rotation 3, acc_bias 3, gravity 1.
#pragma once

#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// The covariance of all if the `count` parameters from `first` on were known: theirs is 0, the others'
/// shrink.
Eigen::MatrixXd whenKnown(const Eigen::MatrixXd& covariance, int first, int count);

/// Largest standard deviation of each.
ImuPrecision precisionOf(const Eigen::MatrixXd& covariance);

}  // namespace slom::calibration
