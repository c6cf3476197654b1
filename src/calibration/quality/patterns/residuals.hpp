// Residuals: found corners minus predicted corners.
#pragma once

#include "calibration/quality/uncertainty/information.hpp"
#include "slom/calibration/dataset.hpp"
#include "slom/calibration/quality.hpp"

namespace slom::calibration {

/// Returns the residuals of all corners of a camera, by image.
std::vector<CornerResidual> residualsOf(const CameraData& data, const FittedRig& rig, std::size_t camera);

/// Returns the `count` largest residuals of all cameras, the worst first. The residuals are those of residualsOf().
std::vector<WorstResidual> worstResiduals(const Dataset& data, const std::vector<CameraQuality>& cameras,
                                          std::size_t count);

/// Returns the median distance of the boards' centres from the cameras that saw them [m].
double boardDistance(const std::map<int, Observation>& observations, const FittedRig& rig);

}  // namespace slom::calibration
