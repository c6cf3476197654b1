// Which of the parameters that all images share trade off against each other.
#pragma once

#include "calibrate/quality/information.hpp"
#include "calibrate/quality/quality.hpp"

namespace slom::app::calib {

Correlations correlationsOf(const SharedColumns& columns, const Eigen::MatrixXd& covariance);

}  // namespace slom::app::calib
