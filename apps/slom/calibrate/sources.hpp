// The input of a calibration: corner files or photographs, as the options give it.
#pragma once

#include "calibrate/settings.hpp"

namespace slom::app::calib {

/// Fills in cameras and board. Throws UserError if neither corner files nor photographs are given, or both, or
/// options that belong to the other kind.
void parseSources(const RawOptions& raw, CommandSettings& settings);

struct NamedFileText {
  std::string name, file;
};
/// Parses `NAME=FILE` of an option. `example` shows how to write the option.
NamedFileText parseNamedFile(const std::string& option, const std::string& text, const char* example);

/// Parses `left=640x480`, or `640x480` for all cameras.
std::map<std::string, ImageSize> parseImageSizes(const std::vector<std::string>& texts,
                                                 const std::vector<CameraFile>& cameras);

}  // namespace slom::app::calib
