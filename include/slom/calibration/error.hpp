/// Errors of the calibration.
#pragma once

#include <string>
#include <vector>

#include "mtk/error.hpp"

namespace slom::calibration {

/// Data or settings that cannot be calibrated from or with. The sentence says where (CameraData::file and line, or camera and
/// image), what is wrong and what to do. Ids begin with `slom.calibration.`:
///   bad-settings   a standard deviation, a limit or a constraint that makes no sense
///   unknown-model  no camera model of this name
///   bad-camera     a camera without a name, or with that of another one; an image size that cannot be; a camera without its
///                  model's parameters
///   bad-view       a view that gives no pose: too few corners, on a line, in no plane, or a corner that is there twice; an image
///                  that a camera has twice
///   bad-corner     a corner whose pixel or place in the world is not finite, or too large
///   bad-reading    a reading that is not finite, or too large, or the second one of its image
///   too-few-views  a camera without two views
///   too-few-data   fewer numbers measured than unknown
///   unconnected    a camera without a common image with the others, directly or through further ones
///   no-pose        common images of two cameras that give no finite pose between them
///   imu-images     a reading of an image that no camera has
///   imu-open       readings that do not determine the IMU, or none at all
///   bad-file       a file of corners or readings that is not as it should be
///   no-board       a corner file of another program that does not say where its corners lie, and nobody else does
///   unused-board   a board stated for corner files that say themselves where their corners lie
///   no-result      uncertainty asked of a calibration that did not succeed, or of other data; a choice among models of which none fits
///   no-quality     a verdict asked of a result without Result::quality, or with that of another one
///   bad-question   a camera, a pixel or a distance that is not there
///   nothing-to-exclude  an exclusion of a camera, an image or a corner that is not there
///   copies         two cameras with the same views, or a camera with one view and copies of it
class DataError : public mtk::Error {
 public:
  /// The sentence of the error in parts, for programs that show them separately.
  struct Parts {
    std::string place;   ///< file, or file and line: `imu.csv:2`
    std::string fault;   ///< `there are no corners of image 7 in any camera`
    std::string remedy;  ///< `correct the number, or leave the reading out`
    /// Each of these sets of parameters, fixed, would be a remedy, too: {{"gravity"}, {"acc_bias"}}.
    std::vector<std::vector<std::string>> worth_fixing{};
  };

  using mtk::Error::Error;
  /// The sentence is `place: fault; remedy`, followed by `, or fix gravity and acc_bias` for each set of `worth_fixing`.
  DataError(std::string id, Parts parts);

  /// Empty but for the ids nothing-to-exclude, too-few-data, bad-reading, imu-images and imu-open.
  const Parts& parts() const noexcept { return parts_; }

 private:
  Parts parts_{};
};

}  // namespace slom::calibration
