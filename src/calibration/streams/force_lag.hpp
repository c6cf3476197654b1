// An accelerometer that lags its gyroscope, which a fit takes for one clock.
#pragma once

#include <vector>

#include "calibration/streams/problem.hpp"

namespace slom::calibration {

/// Doubts that both sensors of an IMU read at the same times. `result` is a fit, by either way, that took them so. Three
/// fits by preintegration, with the forces one reading earlier, as they are, and one reading later, give the lag and its
/// standard deviation. One more fit without the lag shows how large the residuals then are. There is a doubt if the lag is
/// significant. Returns whether there is one: errors of axes then explain a part of the same residuals.
/// Arguments as those of doubtHeldAxes().
bool doubtForceLag(const Dataset& data, const Settings& settings, const CamerasAt& cameras,
                   const std::vector<RigAtImage>& images, const std::vector<StartedImu>& imus, double gravity,
                   const Options& options, StreamResult& result);

}  // namespace slom::calibration
