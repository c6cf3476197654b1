// Tests of suspicions about the residuals of a calibration.
#pragma once

#include <vector>

#include "calibration/quality/uncertainty/information.hpp"
#include "slom/calibration/dataset.hpp"
#include "slom/calibration/options.hpp"
#include "slom/calibration/patterns.hpp"
#include "slom/calibration/quality.hpp"

namespace slom::calibration {

/// Of each camera with images enough, all suspicions that its images can be asked about. `data` is sorted; `covariance`: of all shared parameters, as stated.
std::vector<ResidualPattern> residualPatterns(const Dataset& data, const FittedRig& rig,
                                              const Eigen::MatrixXd& covariance,
                                              const std::vector<ImageGrid>& grids, const Limits& limits);

}  // namespace slom::calibration
