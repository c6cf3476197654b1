// IMUs in motion: the streams that options name, and what the results say about them.
#pragma once

#include <string>
#include <vector>

#include "calibrate/library.hpp"
#include "calibrate/settings.hpp"

namespace slom::app::calib {

/// Parses --imu-stream NAME=FILE and --imu-noise NAME=FILE.
std::vector<ImuFile> parseImuStreams(const std::vector<std::string>& streams,
                                     const std::vector<std::string>& noises,
                                     const std::vector<CameraFile>& cameras);

/// Reads all streams, and the noise of those that have a file of it.
std::vector<ImuStream> readImuStreams(const CommandSettings& settings);

/// Returns the lines of the report about IMUs and gravity. `reference`: name of the first camera.
std::string streamLines(const StreamResult& result, const std::string& reference);

}  // namespace slom::app::calib
