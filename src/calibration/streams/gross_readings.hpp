// Readings that contradict the motion that the images show, such as those of a sensor that hangs for a while.
#pragma once

#include <string>
#include <vector>

#include "calibration/streams/problem.hpp"

namespace slom::calibration {

/// Scale of Cauchy's loss for readings that may be wrong, in standard deviations. Real noise may be ten times that of a usual
/// sensor.
inline constexpr double gross_scale = 30;

/// Finds these readings, for each IMU: fits all, with Cauchy's loss for the readings between two images, so that a few of
/// them hardly count. Returns none if the fit fails.
std::vector<std::vector<GrossReadings>> findGrossReadings(const Dataset& data, const Settings& settings,
                                                          const CamerasAt& cameras,
                                                          const std::vector<RigAtImage>& images,
                                                          const mtk::S2<>& up,
                                                          const std::vector<StartedImu>& imus,
                                                          double gravity);

/// Removes these readings.
void removeReadings(const std::vector<GrossReadings>& gross, ImuStream& imu);

/// Returns the sentence for the report. Empty if there are none.
std::string noteOn(const std::vector<GrossReadings>& gross, const ImuStream& imu);

}  // namespace slom::calibration
