/// Hand-eye calibration: where a camera sits on a hand, from the poses of both over time.
///
///     using namespace slom::calibration;
///     const PoseStream hand = readPoseStream("hand.csv"), camera = readPoseStream("camera.csv");
///     const HandEyeResult result = handEye(hand, camera, {});
///     if (result.success()) std::cout << result.hand_T_camera.pose << "\n";
///
/// The hand is anything whose pose is known in a fixed frame, the base: the flange of a robot, the markers of motion
/// capture, an odometer. The camera is anything else on the same rigid body, with its pose in another fixed frame, the
/// target. At each moment
///
///     base_T_hand(t_hand) * hand_T_camera = base_T_target * target_T_camera(t_camera)      (A X = Y B)
///     t_hand = t_camera + time_offset
///
/// Unknown are X = hand_T_camera, Y = base_T_target, the time offset and, on request, the scale of the camera's
/// translations. The stream with more samples per second is interpolated at the samples of the other one.
///   source   Tsai and Lenz, "A new technique for fully autonomous and efficient 3D robotics hand/eye calibration",
///            1989; Chen, "A screw motion approach to uniqueness analysis of head-eye geometry", 1991; Furrer et al.,
///            "Evaluation of combined time-offset estimation and hand-eye calibration on robotic datasets", 2017
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "slom/calibration/types.hpp"

namespace slom::calibration {

/// A pose of the moving frame in the fixed one, fixed_T_moving.
struct StampedPose {
  double t_s = 0;  ///< time on the clock of its stream; any epoch
  SE3 pose;
  int line = 0;  ///< line in PoseStream::file, for messages; 0: none
};

/// The poses of one moving frame, by rising time.
struct PoseStream {
  std::string file{};  ///< source of the poses in messages; never opened
  std::vector<StampedPose> poses;
  /// False: the source has no times. Then t_s counts the poses, and only HandEyeSettings::pairs accepts the stream.
  bool has_times = true;
  bool is_inverted = false;  ///< the caller inverted the poses of the file, for messages

  /// Returns the source of a pose, with which errors begin: `hand.csv:17`, or `hand.csv: pose 16` if it has no line.
  std::string place(std::size_t index) const;
};

/// Reads poses from a file or pipe: CSV with a header that names columns (t_s, t_ms, t_us or t_ns; x_m, y_m, z_m or x, y,
/// z; qx, qy, qz, qw), in any order, or a trajectory of TUM (`t x y z qx qy qz qw`, separated by blanks). Comments begin
/// with #. Without a column of times, the rows are single poses for HandEyeSettings::pairs. Quaternions are normalised.
/// Throws
/// the errors of io::openInput, and DataError [slom.calibration.bad-file] with file and line.
PoseStream readPoseStream(const std::string& file);

/// What a hand-eye calibration assumes.
struct HandEyeSettings {
  /// If false, time_offset_s is taken as known.
  bool estimate_offset = true;
  double time_offset_s = 0;  ///< t_hand = t_camera + time_offset_s; used if estimate_offset is false
  /// If true, the camera's translations are known up to a factor, as in a monocular map.
  bool estimate_scale = false;
  /// If true, pose i of one stream belongs to pose i of the other, and times are ignored.
  bool pairs = false;
  /// If true, base or target drift, as in odometry and visual odometry. Motions over motion_s are then compared (A X = X
  /// B) instead of poses, and base_T_target does not exist.
  bool drifting = false;
  double motion_s = 1;  ///< length of a motion [s] if `drifting`; more than one sample of each stream
  /// A row is an outlier if its rotation or translation is off by this many standard deviations of most rows.
  double outlier_sigmas = 5;
};

/// A pose with its uncertainty, in the order and with the perturbations of mtk::trafo: translation along the axes of
/// the outer frame [m], then small turns about the axes of the inner frame [rad].
struct PoseEstimate {
  using Deviations = Eigen::Matrix<double, 6, 1, Eigen::DontAlign>;
  SE3 pose;
  /// By the sizes of the residuals, if errors of different rows are independent. NaN: not determined.
  Deviations std = Deviations::Constant(std::numeric_limits<double>::quiet_NaN());
  /// If errors of successive rows depend on each other (slom::clustered on blocks of time). NaN: not determined.
  Deviations std_clustered = std;
};

/// A number with its uncertainty; both standard deviations are 0 for a known number, NaN if it is not determined.
struct NumberEstimate {
  double value = 0, std = 0, std_clustered = 0;
};

/// A row that contradicts the others, and is not used.
struct HandEyeOutlier {
  double t_s = 0;           ///< on the clock of `stream`
  std::string place;        ///< PoseStream::place
  double rotation_deg = 0;  ///< residual
  double translation_m = 0;
};

/// Something that the motion of the streams does not determine.
struct FreeDirection {
  enum class Kind { translation, rotation, time_offset, scale };
  Kind kind = Kind::translation;
  vec3 axis{0., 0., 0.};  ///< unit vector in the frame of the hand; zero for the last two kinds
  std::string text;       ///< what is free, why, and which motion is missing
};

/// How the poses of a stream seem to be meant, other than they were taken.
struct OtherReading {
  bool is_inverse = false;   ///< they are the inverses, moving_T_fixed
  bool has_w_first = false;  ///< quaternions are w, x, y, z in the file where x, y, z, w were read
};

/// A hand-eye calibration: the values found, their uncertainty, and what was left out or remains free.
struct HandEyeResult {
  bool converged = false;
  std::string message;  ///< why the fit stopped, or why it cannot be trusted
  /// Searched for if the streams do not describe one motion. Inverse poses of one stream fit as well as inverse poses of
  /// the other one: the stream with PoseStream::is_inverted is named, or else the camera.
  OtherReading hand_seems, camera_seems;
  std::vector<FreeDirection> free;
  std::vector<std::string> warnings;  ///< on the streams and the fit

  PoseEstimate hand_T_camera;
  std::optional<PoseEstimate> base_T_target;  ///< nothing if HandEyeSettings::drifting
  NumberEstimate time_offset_s;               ///< t_hand = t_camera + value
  NumberEstimate scale{1, 0, 0};              ///< of the camera's translations

  int rows = 0;        ///< rows of the slower stream with a pose of the other one at their time
  int unused = 0;      ///< rows of the slower stream without one
  int motions = 0;     ///< if HandEyeSettings::drifting, motions compared; otherwise 0
  double block_s = 0;  ///< length of the blocks of time of std_clustered [s]; with `pairs` in rows
  std::vector<HandEyeOutlier> outliers;  ///< the worst first
  /// Residuals of the rows that are not outliers: root mean squares and medians of their lengths.
  double rms_rotation_deg = 0, rms_translation_m = 0;
  double median_rotation_deg = 0, median_translation_m = 0;
  /// Standard deviation of each component of a residual, estimated.
  double sigma_rotation_rad = 0, sigma_translation_m = 0;
  /// Root mean square turns of the hand about three axes orthogonal to each other, the largest first.
  vec3 turns_deg{0., 0., 0.};

  /// Returns whether the fit has converged and the motion determines all values.
  bool success() const { return converged && free.empty(); }
};

/// Calibrates a camera on a hand. Gross errors are found and left out. If the motion leaves directions free, the
/// result names them. They are held (translations at 0, rotations at their start), so that all other values have an
/// uncertainty. Throws DataError:
///   [slom.calibration.bad-stream]      fewer than 3 poses, a pose that is not finite, a time earlier than the one
///                                      before, no times, pairs of streams with different numbers of poses
///   [slom.calibration.bad-settings]    a number that is not in its range
///   [slom.calibration.no-common-time]  streams that do not overlap in time, or whose motions nowhere agree
HandEyeResult handEye(const PoseStream& hand, const PoseStream& camera, const HandEyeSettings& settings);

}  // namespace slom::calibration
