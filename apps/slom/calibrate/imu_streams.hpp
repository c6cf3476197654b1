// IMUs in motion: the streams that options name, and what the results say about them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrate/fitted_streams.hpp"
#include "calibrate/library.hpp"
#include "calibrate/settings.hpp"

namespace slom::app::calib {

/// Parses --imu-stream NAME=FILE and --imu-noise NAME=FILE.
std::vector<ImuFile> parseImuStreams(const std::vector<std::string>& streams,
                                     const std::vector<std::string>& noises,
                                     const std::vector<CameraFile>& cameras);

/// Reads all streams, and the noise of those that have a file of it.
std::vector<ImuStream> readImuStreams(const CommandSettings& settings);

/// Fits the cameras and IMUs as the settings say. Prints iterations of splines unless quiet.
FittedStreams fitStreams(const Dataset& data, const CommandSettings& settings, const Result& cameras,
                         const std::vector<ImuStream>& imus);

/// Fits clocks and shutters of the cameras with their motion. Returns the result, and replaces the data by those of
/// synchronised cameras that read all rows at once, if the fit has converged. The settings are then for such data.
StreamResult fitMovingCameras(Dataset& data, CommandSettings& settings, const std::vector<ImuStream>& imus);
/// Completes it by how far a fit by preintegration differs, if that is asked for.
FittedStreams comparedStreams(StreamResult moving, const Dataset& data, const CommandSettings& settings,
                              const Result& cameras, const std::vector<ImuStream>& imus);

/// Returns the lines of the report on how far the fit by splines agrees.
std::string agreementLines(const StreamAgreement& agreement);

/// Returns the lines of the report about IMUs and gravity. `reference`: name of the first camera.
std::string streamLines(const StreamResult& result, const std::string& reference);

}  // namespace slom::app::calib
