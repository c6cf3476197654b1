/// What a calibration assumes, what it holds fixed, and when it gives up.
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

/// A parameter of one camera or of all that is fixed at a value (lower == upper) or kept between two.
struct LensConstraint {
  std::string camera;     ///< its name; empty: all cameras
  std::string parameter;  ///< its name in the model: "k3"
  double lower = 0, upper = 0;

  /// Whether it fixes the parameter instead of bounding it.
  bool isFixed() const { return lower == upper; }
  /// Whether it is about the camera of this name.
  bool concerns(const std::string& name) const { return camera.empty() || camera == name; }
};

/// What is known of the IMU and not estimated.
struct Fixed {
  std::optional<vec3> acc_bias;   ///< [m/s^2]
  std::optional<double> gravity;  ///< magnitude [m/s^2]; the sign is found from the data
};

/// What ends work early, with the best values reached. Results name the limit that was met.
struct Limits {
  double max_seconds = 0;  ///< 0: no limit
  /// The beginning of the time that counts. Without a value each call counts from its own beginning.
  std::optional<std::chrono::steady_clock::time_point> since;
  std::function<bool()> should_stop;  ///< asked often; may be empty
};

/// What becomes of gross corners, which the others contradict (Result::gross).
enum class Robust {
  none,    ///< they count as all others
  reject,  ///< the fit is made again without them, until there are none; good data are not touched. Result::rejected lists them.
  huber,  ///< all corners count by Huber's loss of their distance, except those that are far off before there is a fit (Result::rejected)
  cauchy,  ///< likewise by Cauchy's loss, under which a gross corner hardly counts
};

/// Sigmas lie from 1e-6 to 1e6 (sigma_board from 1e-9 to 1e6 m), Fixed::gravity from 1e-3 to 1e6 m/s^2, components of Fixed::acc_bias within 1e6 m/s^2. A constraint leaves
/// values that a lens may have (focal lengths from 1e-3 to 1e9 px, others within 1e6), and no parameter is constrained twice. DataError
/// [slom.calibration.bad-settings] otherwise.
struct Settings {
  Model model = Model("opencv5");  ///< of all cameras
  double sigma_px = 0.25;          ///< standard deviation of a corner's u and of its v [px]
  double sigma_acc = 0.05;         ///< standard deviation of each axis of a reading [m/s^2]
  Robust robust = Robust::reject;
  SigmaBy sigma_by = SigmaBy::constant;  ///< what sigma_px grows with; by how much is estimated (CornerNoise)
  /// Whether the time is estimated in which cameras read out their rows one after the other (CameraResult::readout). Image numbers count equal
  /// intervals of time then.
  bool rolling_shutter = false;
  BoardShape board_shape = BoardShape::flat;
  /// Of a free board: standard deviation of each coordinate of a corner from where it is stated [m]. Without a value it is estimated.
  std::optional<double> sigma_board;
  Fixed fixed;
  /// Whether the sensor reports gravity itself, so that its readings at rest point down; most report the reaction to it, and point up.
  bool imu_reads_gravity = false;
  std::vector<LensConstraint> lens;
  /// Standard deviation of a prior at 0 on the parameters that a model can trade against others (Model::heldNearZero). Without a value
  /// there is no such prior, unless a fit without it fails; with a board that is not flat it is 1.
  std::optional<double> sigma_denominator;
  int max_iterations = 100;  ///< iteration limit of a fit
  Limits limits;
};

}  // namespace slom::calibration
