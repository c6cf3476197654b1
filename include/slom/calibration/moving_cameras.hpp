/// Cameras in motion with clocks of their own or rolling shutters, and IMUs on their rig.
///
///     StreamSettings stream;
///     stream.camera_offsets = true;      // cameras are not synchronised
///     settings.rolling_shutter = true;   // rows are read one after another
///     const MovingCameras moving = calibrateMovingCameras(data, settings, imus, stream);
///     moving.result.cameras[1].time_offset->value;
///
/// The motion is a spline in time (StreamPath::splines). Each image is seen at its own time, and each row at its own.
///   source   Furgale, Rehder and Siegwart, "Unified temporal and spatial calibration for multi-sensor systems", 2013;
///            Oth, Furgale, Kneip and Siegwart, "Rolling shutter camera calibration", 2013
#pragma once

#include <vector>

#include "slom/calibration/imu_stream.hpp"

namespace slom::calibration {

/// The fit, and the data as synchronised cameras that read all rows at once would have seen them.
struct MovingCameras {
  StreamResult result;
  /// For calibrate(), assess() and calibrateStreams(): each corner is moved by the fitted motion to the time of the
  /// nearest image of the first camera. Views that no spline covers are missing.
  Dataset simultaneous;
};

/// Calibrates each camera by its own images, finds start values of clocks and poses on the rig from the angular
/// velocities, and fits cameras and IMUs together by splines. Estimates the time offsets of cameras if
/// StreamSettings::camera_offsets is true, otherwise trusts the times of the views; and the line delays of all cameras
/// if Settings::rolling_shutter is true. Images of different cameras need not be simultaneous, and their clocks may
/// have any epochs. Image numbers are ignored.
///
/// Throws DataError as calibrate() and calibrateStreams(), and:
///   bad-settings  camera offsets of a single camera
///   no-result     the images of one camera do not calibrate it
///   no-motion     a camera never sees the board while the first one does
MovingCameras calibrateMovingCameras(const Dataset& data, const Settings& settings,
                                     const std::vector<ImuStream>& imus, const StreamSettings& stream);

}  // namespace slom::calibration
