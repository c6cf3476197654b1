// The calibration in the formats of other programs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrate/settings.hpp"

namespace slom::app::calib {

/// A file and its content.
struct OutputText {
  std::string file;
  std::string text;
};

/// Says which estimated times the format has no place for; empty: none.
std::string lostTimes(OutputFormat format, const StreamResult& streams);

/// Returns the files of --output. `streams`: IMUs in motion, of which Kalibr's camchain has the first.
std::vector<OutputText> outputTexts(const Result& result, const StreamResult* streams,
                                    const CommandSettings& settings);

/// Returns the lens as the readers of a format describe it; nothing if they know no such model.
std::optional<ForeignLens> lensFor(OutputFormat format, const Model& model,
                                   const std::vector<double>& parameters);
/// Returns the lens of a camera whose model the readers know.
ForeignLens lensFor(OutputFormat format, const CameraResult& camera);

/// Throws UserError if the readers of the format do not know the model, or need an IMU and there is none.
void requireModelOf(const CommandSettings& settings);

/// Throws UserError if the format stores the size of the images and the size is unknown.
void requireImageSizes(const CommandSettings& settings, const std::vector<CameraData>& cameras);

/// Returns the time of the first IMU minus that of a camera, by its index [s].
double offsetOf(const StreamResult& streams, std::size_t camera);

/// Returns ROS camera_info of one camera.
std::string toRosYaml(const CameraResult& camera);

/// Returns OpenVINS' files of the cameras (kalibr_imucam_chain.yaml) and of the IMU (kalibr_imu_chain.yaml).
std::string toOpenvinsCameras(const Result& result, const StreamResult& streams);
std::string toOpenvinsImu(const ImuStreamResult& imu);

/// Returns Basalt's calibration.
std::string toBasaltJson(const Result& result, const ImuStreamResult& imu);

/// Returns Kalibr's camchain of all cameras. Camera n is given relative to camera n - 1 and, if there are IMUs, to the
/// first.
std::string toKalibrYaml(const Result& result, const StreamResult* streams = nullptr);

}  // namespace slom::app::calib
