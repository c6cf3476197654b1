// Errors of an IMU's axes that a fit held at zero: what they would be.
#pragma once

#include <vector>

#include "calibration/streams/problem.hpp"

namespace slom::calibration {

/// Returns the IMUs, which have the streams and the jumps of the fit, with the values of the fit.
std::vector<StartedImu> startedAt(const StreamResult& result, std::vector<StartedImu> imus);

/// Doubts that the axes of the IMUs are calibrated. `result` is a fit, by either way, that held them so. One more fit, by
/// preintegration, estimates the errors of the axes and the size of the board: both may be wrong, and only together they
/// are told apart. There is a doubt if an error of an axis is significant and either moves the pose or the clock of an
/// IMU far, or explains most of large residuals. Of saturated readings, errors of axes explain a part, so there is no such
/// doubt.
/// `cameras`: the values of the fit. `imus`: with the streams and the jumps of the fit; its values replace theirs.
void doubtHeldAxes(const Dataset& data, const Settings& settings, const CamerasAt& cameras,
                   const std::vector<RigAtImage>& images, std::vector<StartedImu> imus, double gravity,
                   const Options& options, StreamResult& result);

}  // namespace slom::calibration
