// What all fits of cameras and IMUs in motion begin and end with.
#pragma once

#include <cstdint>
#include <vector>

#include "calibration/streams/condensed.hpp"
#include "calibration/streams/problem.hpp"
#include "slom/calibration/imu_stream.hpp"

namespace slom::calibration {

/// Returns the settings of the joint fit: its data have the corners where the cameras' fit put them, at the time of
/// their image.
Settings settingsOfStreams(const Settings& given, const Result& cameras);

/// Returns the options of the joint fit.
Options optionsOfStreams(const Settings& settings);

/// Returns start values of all IMUs, whose streams requireGoodStream() has accepted. `epoch_ns`: zero of the times of the images. Throws the errors of
/// calibrateStreams().
std::vector<StartedImu> startImus(const std::vector<ImuStream>& imus, const std::vector<RigAtImage>& images,
                                  std::int64_t epoch_ns, const StreamSettings& stream);

/// Returns how many times the residuals of the IMUs are as large as they may be: as the given noise predicts, or 10 times
/// as large as those of a usual sensor.
double excessOf(const StreamResult& result);

/// Adds to the result how far it moves the cameras from their own fit, and notes. Refers the offsets of the IMUs to the
/// epochs of the clocks. `is_comparable`: whether the cameras' own fit has the same model, so that a long way is worth a
/// note; that of rolling shutters has not.
void completeResult(const Result& cameras, const CamerasAt& fitted, const std::vector<ImuStream>& imus,
                    std::int64_t epoch_ns, bool is_comparable, StreamResult& result);

}  // namespace slom::calibration
