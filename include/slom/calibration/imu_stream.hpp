/// Camera and IMU in motion: where the IMU sits, how its clock differs, and which way is down.
///
///     Dataset data = readRig(...);                      // corners with time stamps (View::time_ns)
///     const Result cameras = calibrate(data);
///     const StreamResult rig = calibrateStreams(data, settings, cameras, {readImuStream("imu0", "imu0.csv")});
///
/// Between two images, the readings are integrated anew for each value of the clock's offset and the biases. Poses,
/// lenses, the velocity of each IMU at each image and its biases are estimated together.
///   source   Forster et al., "On-manifold preintegration for real-time visual-inertial odometry", 2017
/// With StreamPath::splines, the pose of the reference camera is a spline in time instead, and each reading a measurement
/// at its own time.
///   source   Furgale, Rehder and Siegwart, "Unified temporal and spatial calibration for multi-sensor systems", 2013
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "slom/calibration/options.hpp"
#include "slom/calibration/result.hpp"
#include "slom/measurements/imu_model.hpp"
#include "slom/measurements/imu_samples.hpp"
#include "slom/optimize/summary.hpp"

namespace slom::calibration {

/// The readings of one IMU, in the order of time.
struct ImuStream {
  std::string name;
  std::string file{};               ///< source of the readings in messages
  std::int64_t epoch_ns = 0;        ///< time of the readings' zero, in the clock of the IMU
  std::vector<ImuSample> samples;   ///< times are from the epoch on
  std::optional<ImuNoise> noise{};  ///< nothing: estimated from the residuals
};

/// Errors of an IMU's axes that are estimated (slom::ImuModel), with the names of Kalibr.
enum class ImuAxes {
  calibrated,                      ///< nothing
  scale_misalignment,              ///< force_axes, gyro_axes, gyro_by_force
  scale_misalignment_size_effect,  ///< and force_places
};
/// Returns the name: calibrated, scale-misalignment, scale-misalignment-size-effect.
std::string toString(ImuAxes axes);

/// How the motion between images is described.
enum class StreamPath {
  preintegration,  ///< readings are integrated from one image to the next
  splines,         ///< the motion is a spline, and each reading a measurement at its own time
};

/// Returns `preintegration` or `splines`.
const char* toString(StreamPath path);

/// Settings of calibrateStreams().
struct StreamSettings {
  double gravity = 9.80665;  ///< magnitude [m/s^2]
  /// Offset with which the search for the time offset begins [s]. Nothing: found from the angular rates.
  std::optional<double> time_offset{};
  ImuAxes axes = ImuAxes::calibrated;  ///< of all IMUs
  StreamPath path = StreamPath::preintegration;
  /// Time between knots of splines [s], from 0.001 to 10: short enough for the fastest motion.
  double knot_spacing = 0.03;
  /// If true, calibrateMovingCameras() estimates the time offset of each camera but the first.
  bool camera_offsets = false;
  /// Called after each iteration of the fits by splines; may be empty.
  std::function<void(const IterationRecord&)> progress{};
};

/// A number and its standard deviations: as stated, and for errors that neighbouring images share.
struct StreamNumber {
  double value = 0, std = unknown, std_clustered = unknown;
};

/// A vector and the standard deviations of its components: as stated, and for errors that neighbouring images share.
struct StreamVector {
  vec3 value{0., 0., 0.};
  vec3 std{unknown, unknown, unknown}, std_clustered{unknown, unknown, unknown};
};

/// The axes of an IMU, as slom::ImuModel has them.
struct ImuAxesResult {
  ImuAxes estimated = ImuAxes::calibrated;
  ImuModel<> model;  ///< biases are means over time
  /// Standard deviations of force_axes, gyro_axes, gyro_by_force and force_places, in this order, as many as are estimated.
  std::vector<double> std{}, std_clustered{};
};

/// How the rig moved, in the axes of an IMU: root mean squares.
struct ImuExcitation {
  vec3 turns{unknown, unknown, unknown};   ///< angular velocities [rad/s]
  vec3 forces{unknown, unknown, unknown};  ///< specific forces, without their means [m/s^2]
};

/// What the fit leaves of the readings between two images: their mean minus the prediction.
struct ImuResidual {
  double time = 0, duration = 0;                   ///< of the first image, in the clock of the cameras [s]
  vec3 gyro{0., 0., 0.}, force{0., 0., 0.};        ///< [rad/s], [m/s^2]
  double gyro_std = unknown, force_std = unknown;  ///< of each component, as the noise predicts
};

/// How much means over a time differ from one to the next, while the rig rests (IEEE Std 952-1997, annex C).
struct AllanDeviation {
  double time = 0;             ///< over which readings are averaged [s]
  double gyro = 0, force = 0;  ///< RMS of three axes [rad/s], [m/s^2]
};

/// A reading that was left out because it differs from its neighbours more than any motion explains.
struct ImuSpike {
  bool is_gyro = false;
  int axis = 0;            ///< 0 to 2
  std::size_t sample = 0;  ///< index in ImuStream::samples
  double time = 0;         ///< as ImuSample::time [s]
  double jump = 0;         ///< distance from the mean of its neighbours [rad/s], [m/s^2]
};

/// Readings between two images that contradict the images. They were left out.
struct GrossReadings {
  double from = 0, to = 0;  ///< as ImuSample::time [s]
  double times = 0;         ///< residual, in units of the usual one
};

/// How far two fits of one IMU differ: second fit minus first fit, with the standard deviations of the differences.
struct ImuAgreement {
  std::string name;
  vec3 translation{0., 0., 0.}, translation_std{unknown, unknown, unknown};  ///< of left2imu [m]
  vec3 rotation{0., 0., 0.},
      rotation_std{unknown, unknown, unknown};        ///< about the axes of the reference camera [rad]
  double time_offset = 0, time_offset_std = unknown;  ///< [s]
  /// Differences of the errors of axes, in the order of ImuAxesResult::std; empty unless both fits estimate the same
  /// errors.
  std::vector<double> axes{}, axes_std{};

  /// Returns the largest difference in standard deviations, and its name, as `imu0.translation.x`.
  std::pair<double, std::string> largest() const;
};

/// A bias that jumps and stays. `change` was subtracted from all readings after it, and the readings around it were left
/// out.
struct BiasJump {
  bool is_gyro = false;
  double time = 0;          ///< as ImuSample::time [s]
  vec3 change{0., 0., 0.};  ///< [rad/s], [m/s^2]
  double margin = 0;        ///< readings are left out so long before and after it [s]
};

/// One IMU.
struct ImuStreamResult {
  std::string name, file;
  /// Readings left out, in the order of time; none with Robust::none.
  std::vector<ImuSpike> spikes;
  std::vector<GrossReadings> gross;  ///< likewise
  std::size_t samples = 0;           ///< readings between the first and the last image
  std::size_t intervals = 0;         ///< pairs of successive images with readings between
  double rate = 0;                   ///< of the readings, in the median [Hz]
  SE3 left2imu;                      ///< moves points of the reference camera into the frame of the IMU
  vec3 translation_std{unknown, unknown, unknown}, translation_clustered{unknown, unknown, unknown};  ///< [m]
  /// About the axes of the reference camera [rad].
  vec3 rotation_std{unknown, unknown, unknown}, rotation_clustered{unknown, unknown, unknown};
  /// Of the components of log(rotation) [rad].
  vec3 rotation_vector_std{unknown, unknown, unknown}, rotation_vector_clustered{unknown, unknown, unknown};
  double time_offset = 0;  ///< t_imu - t_camera [s]
  double time_offset_std = unknown, time_offset_clustered = unknown;
  vec3 gyro_bias{0., 0., 0.}, force_bias{0., 0., 0.};  ///< means over time [rad/s], [m/s^2]
  ImuAxesResult axes;
  ImuExcitation excitation;
  /// Root mean square of the differences between the mean readings of an interval and those that the fit predicts.
  double rms_gyro = unknown, rms_force = unknown;
  ImuNoise noise;               ///< densities of the fit
  bool noise_is_given = false;  ///< from the caller, not from the residuals
  /// Root mean square of the residuals, divided by the value that `noise` predicts: 1 if the stated noise is right.
  double gyro_ratio = unknown, force_ratio = unknown;
  std::vector<ImuResidual> residuals;  ///< in the order of time
  double rest_from = unknown,
         rest_to = unknown;             ///< longest rest of 5 s or more, since the first reading [s]
  std::vector<AllanDeviation> at_rest;  ///< of that rest, times rising; empty: there is none
  /// Two fits with all images, one with the readings of each half of the recording: second half minus first half. Nothing
  /// if one of the fits failed, or if the motion is a spline.
  std::optional<ImuAgreement> halves{};
  /// Standard deviations of the biases [rad/s], [m/s^2].
  vec3 gyro_bias_std{unknown, unknown, unknown}, gyro_bias_clustered{unknown, unknown, unknown};
  vec3 force_bias_std{unknown, unknown, unknown}, force_bias_clustered{unknown, unknown, unknown};
  std::vector<BiasJump> jumps;  ///< in the order of time; biases are those before the first one
  /// Lag of the accelerometer behind the gyroscope [s]; nothing: no lag was found. The fit removes the lag, so `time_offset`
  /// is the gyroscope's.
  /// If residuals exceed the noise, the standard deviation is larger than stated by the same factor.
  std::optional<StreamNumber> force_lag{};
};

/// When one camera sees its corners: row v of an image with the time t_camera is read at
///   t_camera - time_offset + line_delay v      in the clock of the reference camera
struct CameraStreamResult {
  std::string name;
  std::optional<StreamNumber> time_offset{};  ///< t_camera - t_reference [s]; nothing: not estimated
  std::optional<StreamNumber> line_delay{};   ///< time from one row to the next [s]; nothing: not estimated
  SE3 left2camera;                            ///< from the reference camera
  vec3 translation_std{unknown, unknown, unknown}, translation_clustered{unknown, unknown, unknown};  ///< [m]
  /// About the axes of the reference camera [rad].
  vec3 rotation_std{unknown, unknown, unknown}, rotation_clustered{unknown, unknown, unknown};
};

/// A pose at a time.
struct TimedPose {
  double time = 0;  ///< since the first image [s]
  SE3 pose;
};

/// All IMUs, gravity, and how the fit ended.
struct StreamResult {
  StreamPath path = StreamPath::preintegration;
  bool converged = false;
  std::string stop_reason, message;
  /// Why there are no standard deviations; empty: there are, or the fit has not converged.
  std::string undetermined;
  int iterations = 0;
  std::size_t unknowns = 0, measurements = 0;
  double sigma_px = 0;                     ///< of a corner, as the cameras' own fit found it [px]
  vec3 gravity{0., 0., 0.};                ///< in the frame of the board, downwards [m/s^2]
  double gravity_direction_std = unknown;  ///< larger of two directions [rad]
  double gravity_direction_clustered = unknown;
  std::vector<ImuStreamResult> imus;
  std::vector<CameraStreamResult> cameras;  ///< of calibrateMovingCameras(); otherwise empty
  /// Largest change of a camera's parameter or pose from the cameras' own fit, in standard deviations of that fit. A
  /// large one means that cameras and IMU contradict each other.
  double largest_camera_change = unknown;
  std::string most_changed;        ///< name of that parameter
  std::vector<TimedPose> poses;    ///< of the reference camera in the frame of the board
  std::vector<std::string> notes;  ///< sentences on what the streams lack, and on what contradicts them
  /// Clauses on what speaks against the values, for verdictOf().
  std::vector<std::string> doubts;

  /// Returns whether the fit converged and the data determine all values.
  bool success() const { return converged && undetermined.empty(); }
};

/// Fits cameras and IMUs together. `cameras` is the result of calibrate() with these data and settings, and must have
/// succeeded. All views need times (View::time_ns).
///
/// Throws DataError:
///   bad-stream    samples that are not finite, or whose times do not rise; no common time with the images; fewer than
///                 two images with readings between; readings in degrees, in units of gravity, of axes of the other
///                 hand, forces in place of angular velocities or in other axes; images without times
///   no-motion     angular velocities of cameras and IMU that do not correlate, so that no time offset is found; turns about
///                 one axis only
///   no-result     `cameras` did not succeed
///   bad-settings  a knot spacing out of range; camera offsets
StreamResult calibrateStreams(const Dataset& data, const Settings& settings, const Result& cameras,
                              const std::vector<ImuStream>& imus, const StreamSettings& stream = {});

/// Reads an IMU from a table with a header and seven columns: time, angular velocity [rad/s], specific force [m/s^2].
/// The header may state the unit of the times: `t_s`, `t_ms`, `t_us`, `t_ns`, `timestamp [us]`. Otherwise times with a
/// decimal point are seconds, others ns. EuRoC's and Kalibr's files have this form. If the name is a folder, reads the
/// data.csv in it, as EuRoC has it. Throws the errors of io::openInput, and DataError [slom.calibration.bad-file] with
/// file and line for malformed rows and for times that do not rise.
ImuStream readImuStream(const std::string& name, const std::string& path);

/// Reads densities of noise from Kalibr's imu.yaml: gyroscope_noise_density, gyroscope_random_walk,
/// accelerometer_noise_density, accelerometer_random_walk. EuRoC's sensor.yaml has these keys too. If the name is a
/// folder, reads the sensor.yaml in it. Throws likewise.
ImuNoise readImuNoise(const std::string& path);

}  // namespace slom::calibration
