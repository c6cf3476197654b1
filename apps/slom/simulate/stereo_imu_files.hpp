#pragma once
// The files of a simulated stereo camera with an accelerometer.

#include <filesystem>

#include "simulate/stereo_imu.hpp"

namespace slom::app {

/// Writes left_corners.csv, right_corners.csv and imu.csv, which `slom calibrate` reads, and truth.json,
/// whose keys are those of that command's result, into `folder`, which is made where it is missing. All files
/// are complete or none is there; throws UserError where they cannot be written.
void writeStereoImu(const StereoImuData& data, const StereoImuOptions& options,
                    const std::filesystem::path& folder);

}  // namespace slom::app
