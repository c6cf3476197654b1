// Correlations between the parameters that all images share: which ones trade off against each other.
#pragma once

#include "calibration/quality/uncertainty/information.hpp"
#include "slom/calibration/quality.hpp"

namespace slom::calibration {

Correlations correlationsOf(const SharedColumns& columns, const Eigen::MatrixXd& covariance);

}  // namespace slom::calibration
