/// Errors of the calibration.
#pragma once

#include <string>
#include <vector>

#include "mtk/error.hpp"

namespace slom::calibration {

/// Error for invalid data or settings. The sentence says where (CameraData::file and line, or camera and image), what
/// is wrong and what to do. Ids begin with `slom.calibration.`:
///   bad-settings        an invalid standard deviation, limit or constraint
///   unknown-model       no camera model has this name
///   bad-camera          a camera without a name, or with that of another one; an impossible image size; a camera
///                       without its model's parameters
///   bad-view            a view that gives no pose: too few corners, on a line, in no plane, or a corner that is there
///                       twice; an image that a camera has twice
///   bad-corner          a corner whose pixel or place in the world is not finite, or too large
///   bad-reading         a reading that is not finite, or too large, or the second one of its image
///   too-few-views       a camera without two views
///   too-few-data        fewer measured numbers than unknowns
///   unconnected         a camera without a common image with the others, directly or through further ones
///   no-pose             common images of two cameras that give no finite pose between them
///   imu-images          a reading of an image that no camera has
///   imu-open            readings that do not determine the IMU, or no readings
///   bad-stream          readings of an IMU in motion, or poses of a hand, that cannot be used: too few, not finite, times
///                       that do not rise, wrong units or axes, none while images were taken, or images without times
///   no-motion           turns of cameras and IMU that do not correlate, so that no time offset is found
///   bad-file            a malformed file of corners or readings
///   no-board            a corner file of another program without the places of its corners, if nobody gave them
///   unused-board        a board given for corner files that contain the places of their corners
///   no-result           uncertainty requested for a calibration that did not succeed, or for other data; a choice
///                       among models, none of which fits
///   no-quality          a verdict requested for a result without Result::quality, or with that of another result
///   bad-question        a camera, a pixel or a distance that does not exist
///   nothing-to-exclude  an exclusion of a camera, an image or a corner that does not exist
///   copies              two cameras with the same views, or a camera with one view and copies of it
///   no-common-time      streams of poses that do not overlap in time, or that nowhere move alike
class DataError : public mtk::Error {
 public:
  /// The sentence of the error in parts, for programs that show the parts separately.
  struct Parts {
    std::string place;   ///< file, or file and line: `imu.csv:2`
    std::string fault;   ///< `there are no corners of image 7 in any camera`
    std::string remedy;  ///< `correct the number, or leave the reading out`
    /// Sets of parameters. Fixing any one of these sets would be a remedy, too: {{"gravity"}, {"acc_bias"}}.
    std::vector<std::vector<std::string>> worth_fixing{};
  };

  using mtk::Error::Error;
  /// Creates the error with the sentence `place: fault; remedy`, followed by `, or fix gravity and acc_bias` for each
  /// set of `worth_fixing`.
  DataError(std::string id, Parts parts);

  /// Returns the parts. Empty except for the ids nothing-to-exclude, too-few-data, bad-reading, imu-images and
  /// imu-open.
  const Parts& parts() const noexcept { return parts_; }

 private:
  Parts parts_{};
};

}  // namespace slom::calibration
