#pragma once
// The files of a simulated stereo camera with an IMU in motion.

#include <filesystem>

#include "simulate/stereo_imu_stream.hpp"

namespace slom::app {

/// Writes cam0_corners.csv, cam1_corners.csv, imu0.csv and imu.yaml, which `slom calibrate` reads, and truth.json with
/// the keys of that command's result. Creates `folder` if it does not exist. Either all files are written completely or
/// none. Throws UserError if they cannot be written.
void writeStereoImuStream(const StereoImuStreamData& data, const StereoImuStreamOptions& options,
                          const std::filesystem::path& folder);

}  // namespace slom::app
