// The calibration in the formats that other programs read.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrate/settings.hpp"

namespace slom::app::calib {

/// A file and what is in it.
struct OutputText {
  std::string file;
  std::string text;
};

/// The files of --output.
std::vector<OutputText> outputTexts(const Result& result, const CommandSettings& settings);

/// The lens as the readers of a format describe it; nothing where they know no such model.
std::optional<ForeignLens> lensFor(OutputFormat format, const Model& model,
                                   const std::vector<double>& parameters);
/// The lens of a camera whose model the readers know.
ForeignLens lensFor(OutputFormat format, const CameraResult& camera);

/// UserError when the readers of the format do not know the model.
void requireModelOf(const CommandSettings& settings);

/// UserError when the format stores the size of the images and it is unknown.
void requireImageSizes(const CommandSettings& settings, const std::vector<CameraData>& cameras);

/// ROS camera_info of one camera.
std::string toRosYaml(const CameraResult& camera);

/// Kalibr's camchain of all cameras; camera n is given from camera n - 1.
std::string toKalibrYaml(const Result& result);

}  // namespace slom::app::calib
