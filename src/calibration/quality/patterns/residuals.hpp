// What is left between the corners that were found and those that the calibration predicts.
#pragma once

#include "calibration/quality/uncertainty/information.hpp"
#include "slom/calibration/dataset.hpp"
#include "slom/calibration/quality.hpp"

namespace slom::calibration {

/// The residuals of all corners of a camera, by image.
std::vector<CornerResidual> residualsOf(const CameraData& data, const FittedRig& rig, std::size_t camera);

/// The `count` corners of all cameras of the data with the largest residuals, which are those of residualsOf, the worst first.
std::vector<WorstResidual> worstResiduals(const Dataset& data, const std::vector<CameraQuality>& cameras,
                                          std::size_t count);

/// Median distance of the boards' centres from the cameras that saw them [m].
double boardDistance(const std::map<int, Observation>& observations, const FittedRig& rig);

}  // namespace slom::calibration
