#pragma once
// The files of a simulated stereo camera with an accelerometer.

#include <filesystem>

#include "simulate/stereo_imu.hpp"

namespace slom::app {

/// Writes left_corners.csv, right_corners.csv and imu.csv, which `slom calibrate` reads, and truth.json with the keys
/// of that command's result. Creates `folder` if it does not exist. Either all files are written completely or none.
/// Throws UserError if they cannot be written.
void writeStereoImu(const StereoImuData& data, const StereoImuOptions& options,
                    const std::filesystem::path& folder);

}  // namespace slom::app
