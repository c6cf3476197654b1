// Tests for patterns in the residuals of a calibration.
#pragma once

#include <vector>

#include "calibration/quality/uncertainty/information.hpp"
#include "slom/calibration/dataset.hpp"
#include "slom/calibration/options.hpp"
#include "slom/calibration/patterns.hpp"
#include "slom/calibration/quality.hpp"

namespace slom::calibration {

/// Runs, for each camera with enough images, all tests that its images allow. `data` must be sorted; `covariance`: of
/// all shared parameters, as stated.
std::vector<ResidualPattern> residualPatterns(const Dataset& data, const FittedRig& rig,
                                              const Eigen::MatrixXd& covariance,
                                              const std::vector<ImageGrid>& grids, const Limits& limits);

}  // namespace slom::calibration
