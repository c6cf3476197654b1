// An accelerometer that lags its gyroscope, which a fit takes for one clock.
#pragma once

#include <optional>
#include <vector>

#include "calibration/streams/problem.hpp"

namespace slom::calibration {

/// Lags of accelerometers behind their gyroscopes, by IMU; nothing: none was found.
using ForceLags = std::vector<std::optional<StreamNumber>>;

/// Stated standard deviations of a lag that is no chance. Errors that images share make them too small.
inline constexpr double significant_lag = 10;

/// Finds lags of at least so many standard deviations. Three fits by preintegration, with the forces one reading earlier,
/// as they are, and one reading later, give the lag and its standard deviation. One more fit without the lag shows how large
/// the residuals then are. A fit that fails finds no lag. `cameras`, `up` and `imus`: values and noise to begin with.
ForceLags findForceLags(const Dataset& data, const Settings& settings, const CamerasAt& cameras,
                        const std::vector<RigAtImage>& images, const mtk::S2<>& up,
                        const std::vector<StartedImu>& imus, double gravity, const Options& options,
                        double least_deviations = significant_lag);

/// Reads the forces `lag` later: they are then those at the times of the angular velocities.
void removeLag(double lag, ImuStream& imu);

/// Adds the lags to the result, and a doubt for each.
void reportLags(const ForceLags& lags, StreamResult& result);

}  // namespace slom::calibration
