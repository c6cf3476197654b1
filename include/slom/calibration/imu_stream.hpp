/// Camera and IMU in motion: where the IMU sits, how its clock differs, and which way is down.
///
///     Dataset data = readRig(...);                      // corners with time stamps (View::time_ns)
///     const Result cameras = calibrate(data);
///     const StreamResult rig = calibrateStreams(data, settings, cameras, {readImuStream("imu0", "imu0.csv")});
///
/// Between two images, the readings are integrated anew for each value of the clock's offset and the biases. Poses,
/// lenses, the velocity of each IMU at each image and its biases are estimated together.
///   source   Forster et al., "On-manifold preintegration for real-time visual-inertial odometry", 2017
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "slom/calibration/options.hpp"
#include "slom/calibration/result.hpp"
#include "slom/measurements/imu_samples.hpp"

namespace slom::calibration {

/// The readings of one IMU, in the order of time.
struct ImuStream {
  std::string name;
  std::string file{};               ///< source of the readings in messages
  std::int64_t epoch_ns = 0;        ///< time of the readings' zero, in the clock of the IMU
  std::vector<ImuSample> samples;   ///< times are from the epoch on
  std::optional<ImuNoise> noise{};  ///< nothing: estimated from the residuals
};

/// Settings of calibrateStreams().
struct StreamSettings {
  double gravity = 9.80665;  ///< magnitude [m/s^2]
  /// Offset with which the search for the time offset begins [s]. Nothing: found from the angular rates.
  std::optional<double> time_offset{};
};

/// A vector and the standard deviations of its components: as stated, and for errors that neighbouring images share.
struct StreamVector {
  vec3 value{0., 0., 0.};
  vec3 std{unknown, unknown, unknown}, std_clustered{unknown, unknown, unknown};
};

/// One IMU.
struct ImuStreamResult {
  std::string name, file;
  std::size_t samples = 0;    ///< readings between the first and the last image
  std::size_t intervals = 0;  ///< pairs of successive images with readings between
  SE3 left2imu;               ///< moves points of the reference camera into the frame of the IMU
  vec3 translation_std{unknown, unknown, unknown}, translation_clustered{unknown, unknown, unknown};  ///< [m]
  /// About the axes of the reference camera [rad].
  vec3 rotation_std{unknown, unknown, unknown}, rotation_clustered{unknown, unknown, unknown};
  /// Of the components of log(rotation) [rad].
  vec3 rotation_vector_std{unknown, unknown, unknown}, rotation_vector_clustered{unknown, unknown, unknown};
  double time_offset = 0;  ///< t_imu - t_camera [s]
  double time_offset_std = unknown, time_offset_clustered = unknown;
  vec3 gyro_bias{0., 0., 0.}, force_bias{0., 0., 0.};  ///< means over time [rad/s], [m/s^2]
  /// Root mean square of the differences between the mean readings of an interval and those that the fit predicts.
  double rms_gyro = unknown, rms_force = unknown;
  ImuNoise noise;               ///< densities of the fit
  bool noise_is_given = false;  ///< from the caller, not from the residuals
  /// Residuals divided by what `noise` predicts, as root mean square: 1 if the stated noise is right.
  double gyro_ratio = unknown, force_ratio = unknown;
};

/// All IMUs, gravity, and how the fit ended.
struct StreamResult {
  bool converged = false;
  std::string stop_reason, message;
  /// Why there are no standard deviations; empty: there are, or the fit has not converged.
  std::string undetermined;
  int iterations = 0;
  std::size_t unknowns = 0, measurements = 0;
  double sigma_px = 0;                     ///< of a corner, as the cameras' own fit found it [px]
  vec3 gravity{0., 0., 0.};                ///< in the frame of the board, downwards [m/s^2]
  double gravity_direction_std = unknown;  ///< larger of two directions [rad]
  std::vector<ImuStreamResult> imus;
  /// Largest change of a camera's parameter or pose from the cameras' own fit, in standard deviations of that fit. A
  /// large one means that cameras and IMU contradict each other.
  double largest_camera_change = unknown;
  std::string most_changed;        ///< name of that parameter
  std::vector<std::string> notes;  ///< sentences on what the streams lack, and on what contradicts them

  /// Returns whether the fit converged and the data determine all values.
  bool success() const { return converged && undetermined.empty(); }
};

/// Fits cameras and IMUs together. `cameras` is the result of calibrate() with these data and settings, and must have
/// succeeded. All views need times (View::time_ns).
///
/// Throws DataError:
///   bad-stream    samples that are not finite, or whose times do not rise; no common time with the images; fewer than
///                 two images with readings between; readings in degrees, in units of gravity, of axes of the other
///                 hand, or forces in other axes than angular velocities; images without times
///   no-motion     angular velocities of cameras and IMU that do not correlate, so that no time offset is found; turns about
///                 one axis only
///   no-result     `cameras` did not succeed
StreamResult calibrateStreams(const Dataset& data, const Settings& settings, const Result& cameras,
                              const std::vector<ImuStream>& imus, const StreamSettings& stream = {});

/// Reads an IMU from a table with a header and seven columns: time, angular velocity [rad/s], specific force [m/s^2].
/// Times are whole numbers in ns, or seconds if they have a decimal point or the header says `t_s`. EuRoC's and Kalibr's
/// files have this form. Throws the errors of io::openInput, and DataError [slom.calibration.bad-file] with file and line
/// for malformed rows and for times that do not rise.
ImuStream readImuStream(const std::string& name, const std::string& file);

/// Reads densities of noise from Kalibr's imu.yaml: gyroscope_noise_density, gyroscope_random_walk,
/// accelerometer_noise_density, accelerometer_random_walk. EuRoC's sensor.yaml has these keys, too. Throws likewise.
ImuNoise readImuNoise(const std::string& file);

}  // namespace slom::calibration
