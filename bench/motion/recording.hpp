// Recordings from files.
#pragma once

#include <string>

namespace slom::bench {

/// Fits a recording in all ways and prints a row for each. Returns the exit status.
int fitRecording(const std::string& poses_file, const std::string& imu_file);

}  // namespace slom::bench
