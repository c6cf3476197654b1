// Streams of an IMU as data: what cannot be used, and what the result should mention.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "slom/calibration/imu_stream.hpp"

namespace slom::calibration {

/// Returns the file of an IMU or, if that is empty, its name: with it messages begin.
std::string nameOf(const ImuStream& imu);

/// Throws DataError [slom.calibration.bad-stream].
[[noreturn]] void badStream(const ImuStream& imu, const std::string& fault, const std::string& remedy);

/// Throws DataError [slom.calibration.bad-stream] if a view has no time.
void requireTime(const CameraData& camera, const View& view);

/// Throws DataError [slom.calibration.bad-stream] if samples are not finite, their times do not rise, there are fewer than
/// two, a density of the noise is not positive, or the forces are not in m/s^2.
void requireGoodStream(const ImuStream& imu);

/// Returns the times between which readings are missing: gaps of more than 5 usual intervals, in seconds from the epoch.
std::vector<std::pair<double, double>> gapsOf(const ImuStream& imu);

/// Notes gaps, and doubts axes that stay at their largest reading as those of a saturated sensor do.
void noteFaults(const ImuStream& imu, StreamResult& result);

/// Returns whether readings of an axis stay at its largest magnitude.
bool isSaturated(const ImuStream& imu);

}  // namespace slom::calibration
