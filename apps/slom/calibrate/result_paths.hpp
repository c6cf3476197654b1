// Where results go.
#pragma once

#include "calibrate/settings.hpp"
#include "output_files.hpp"

namespace slom::app::calib {

/// The format that --format names or, where that is empty, the name of the file: Kalibr's are called camchain, ROS wants one
/// for each camera, whose place in the name is `{name}`.
OutputFormat parseFormat(const std::string& format, const std::string& file, std::size_t cameras);

/// The files of --output: one, or one for each camera; none where none is wanted.
std::vector<std::string> outputFiles(const CommandSettings& settings);

/// The files of --corners-out, one for each camera; none where none are wanted.
std::vector<std::string> cornerFiles(const CommandSettings& settings);

/// All of them, with their options.
std::vector<NamedFile> resultFiles(const CommandSettings& settings);

}  // namespace slom::app::calib
