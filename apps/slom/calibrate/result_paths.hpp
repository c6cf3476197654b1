// The files of the results.
#pragma once

#include "calibrate/settings.hpp"
#include "output_files.hpp"

namespace slom::app::calib {

/// Returns the format named by --format. If that is empty, the name of the file decides: Kalibr's are called
/// camchain, and ROS needs one file per camera, with `{name}` in place of the camera's name.
OutputFormat parseFormat(const std::string& format, const std::string& file, std::size_t cameras);

/// Returns the files of --output: one, one for each camera, or none.
std::vector<std::string> outputFiles(const CommandSettings& settings);

/// Returns the files of --corners-out: one for each camera, or none.
std::vector<std::string> cornerFiles(const CommandSettings& settings);

/// Returns all files of results, with their options.
std::vector<NamedFile> resultFiles(const CommandSettings& settings);

}  // namespace slom::app::calib
