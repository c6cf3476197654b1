/// Settings of a calibration: what it assumes, what it fixes, and when it gives up.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "slom/calibration/board_shape.hpp"
#include "slom/calibration/corner_noise.hpp"
#include "slom/calibration/models.hpp"
#include "slom/calibration/types.hpp"

namespace slom::calibration {

/// A constraint of a parameter of one or all cameras: fixed at a value (lower == upper) or kept between two values.
struct LensConstraint {
  std::string camera;     ///< name of the camera; empty: all cameras
  std::string parameter;  ///< name in the model: "k3"
  double lower = 0, upper = 0;

  /// Returns whether the constraint fixes the parameter instead of bounding it.
  bool isFixed() const { return lower == upper; }
  /// Returns whether the constraint applies to the camera of this name.
  bool concerns(const std::string& name) const { return camera.empty() || camera == name; }
};

/// Values of the IMU that are known and not estimated.
struct Fixed {
  std::optional<vec3> acc_bias;   ///< [m/s^2]
  std::optional<double> gravity;  ///< magnitude [m/s^2]; the sign comes from the data
};

/// Limits that end work early, with the best values reached. Results name the limit that was met.
struct Limits {
  double max_seconds = 0;  ///< 0: no limit
  /// Start of the time measurement. Without a value, each call measures from its own start.
  std::optional<std::chrono::steady_clock::time_point> since;
  std::function<bool()> should_stop;  ///< called often; may be empty
};

/// Treatment of gross corners, which the other corners contradict (Result::gross).
enum class Robust {
  none,  ///< gross corners count like all others
  /// The fit is repeated without gross corners until there are none. Good data are not changed. Result::rejected lists
  /// the gross corners.
  reject,
  /// All corners count by Huber's loss of their distance, except those that are far off before the first fit
  /// (Result::rejected).
  huber,
  cauchy,  ///< the same with Cauchy's loss, under which a gross corner hardly counts
};

/// Settings of a calibration. Sigmas lie from 1e-6 to 1e6 (sigma_board from 1e-9 to 1e6 m), Fixed::gravity from 1e-3 to
/// 1e6 m/s^2, components of Fixed::acc_bias within 1e6 m/s^2. A constraint must leave values that a lens may have
/// (focal lengths from 1e-3 to 1e9 px, others within 1e6). No parameter may be constrained twice. Otherwise calibrate
/// throws DataError [slom.calibration.bad-settings].
struct Settings {
  Model model = Model("opencv5");  ///< of all cameras
  double sigma_px = 0.25;          ///< standard deviation of a corner's u and of its v [px]
  double sigma_acc = 0.05;         ///< standard deviation of each axis of a reading [m/s^2]
  Robust robust = Robust::reject;
  /// Quantity with which sigma_px grows. The growth is estimated (CornerNoise).
  SigmaBy sigma_by = SigmaBy::constant;
  /// If true, estimates the time in which cameras read out their rows one after another (CameraResult::readout). Image
  /// numbers then count equal intervals of time.
  bool rolling_shutter = false;
  BoardShape board_shape = BoardShape::flat;
  /// For a free board, standard deviation of each coordinate of a corner from its stated position [m]. Without a value
  /// it is estimated.
  std::optional<double> sigma_board;
  Fixed fixed;
  /// True if the sensor reports gravity itself, so that its readings at rest point down. Most sensors report the
  /// reaction to gravity, which points up.
  bool imu_reads_gravity = false;
  std::vector<LensConstraint> lens;
  /// Standard deviation of a prior at 0 on parameters that a model can trade against others (Model::heldNearZero).
  /// Without a value there is no such prior, unless a fit without it fails. With a board that is not flat it is 1.
  std::optional<double> sigma_denominator;
  int max_iterations = 100;  ///< iteration limit of a fit
  Limits limits;
};

}  // namespace slom::calibration
