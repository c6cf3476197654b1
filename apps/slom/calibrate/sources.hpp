// What a calibration is made from, as options say it: corner files or photographs.
#pragma once

#include "calibrate/settings.hpp"

namespace slom::app::calib {

/// Fills in cameras and board. UserError when neither corner files nor photographs are given, or both, or
/// what belongs to the others.
void parseSources(const RawOptions& raw, CommandSettings& settings);

/// `left=640x480`, or `640x480` for all cameras.
std::map<std::string, ImageSize> parseImageSizes(const std::vector<std::string>& texts,
                                                 const std::vector<CameraFile>& cameras);

}  // namespace slom::app::calib
