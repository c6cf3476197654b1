// Where results go.
#pragma once

#include "calibrate/settings.hpp"
#include "output_files.hpp"

namespace slom::app::calib {

/// By the text of --format, or where that is empty by the file: Kalibr's are called camchain, ROS wants one
/// for each camera, whose place in the name is `{name}`.
OutputFormat parseFormat(const std::string& format, const std::string& file, std::size_t cameras);

/// Of --output: one, or one for each camera; none where none is wanted.
std::vector<std::string> outputFiles(const CommandSettings& settings);

/// Of --corners-out, one for each camera; none where none are wanted.
std::vector<std::string> cornerFiles(const CommandSettings& settings);

/// All of them, with their options.
std::vector<NamedFile> resultFiles(const CommandSettings& settings);

}  // namespace slom::app::calib
