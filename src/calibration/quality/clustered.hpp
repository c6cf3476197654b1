// Uncertainty of the parameters that all images share, where errors are dependent within images, within blocks of images that follow each
// other, and at points of the board (ClusteredUncertainty).
#pragma once

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// Fills Result::clustered and the clustered standard deviations of a result that succeeded, from `data`, which is sorted. Others stay as they
/// are.
void addClustered(const Dataset& data, Result& result);

/// The matrix of ClusteredUncertainty::covariance.
Eigen::MatrixXd covarianceOf(const ClusteredUncertainty& clustered);

}  // namespace slom::calibration
