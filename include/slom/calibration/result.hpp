/// Result: the calibration as plain numbers, independent of any output format. Standard deviations follow from the
/// stated sigmas, for independent errors. Those named `..._clustered` are for errors that the corners of an image, or
/// of neighbouring images, share (ClusteredUncertainty). Both are 0 for fixed values. Both are NaN if the data do not
/// determine the value; `undetermined` then gives the reason.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "slom/calibration/comparison.hpp"
#include "slom/calibration/options.hpp"
#include "slom/calibration/quality.hpp"
#include "slom/calibration/readout.hpp"

namespace slom::calibration {

inline constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// A parameter of a lens: value and standard deviation in its own unit; px for focal lengths and image centre.
struct Parameter {
  std::string name;
  double value = 0, std = unknown;
  double std_clustered = unknown;
  double dof = unknown;  ///< degrees of freedom of std_clustered
};

/// Standard deviations and their degrees of freedom, for errors that images share.
struct ClusteredVector {
  vec3 std = vec3(unknown, unknown, unknown);
  vec3 dof = vec3(unknown, unknown, unknown);
};

/// Uncertainty of the parameters that all images share, for dependent errors. Errors may depend in any way within an
/// image, within blocks of images with successive numbers, and between images at the same corner of the board.
///   source   docs/decisions/clustered_uncertainty.md
struct ClusteredUncertainty {
  int images = 0;          ///< groups of the first way
  int board_points = 0;    ///< groups of the second way; 0: too few, only images count
  int block_length = 1;    ///< number of images in a block
  int blocks = 0;          ///< number of blocks
  bool levels_off = true;  ///< false: errors are shared over more images than the longest blocks have
  /// Ratio of the standard deviations to the standard deviations of the longest blocks, if these do not level off. 1
  /// if they level off. Also 1 if there are too few images to see this; standard deviations are then too small.
  double extrapolation = 1;
  /// Ratio of the clustered to the stated standard deviation, as root mean square over all directions of the
  /// parameters: by images, by blocks of images, and by blocks and points of the board.
  double ratio_by_image = unknown, ratio_by_block = unknown, ratio = unknown;
  /// Covariance of the parameters of the cameras, row by row. For each camera except the first, the pose left2camera
  /// (translation, rotation) follows its parameters. After the cameras follow the IMU's rotation, acc_bias and gravity.
  std::vector<double> covariance;

  /// Number of images below which projection uncertainty, halves and verdict use the stated standard deviations.
  static constexpr int fewest_images = 10;
  /// Returns whether there are enough images for the clustered standard deviations to replace the stated ones.
  bool isReliable() const { return images >= fewest_images; }
};

/// Returns the limits of these numbers, a sentence each: few images, errors shared for longer than can be seen, ...
std::vector<std::string> sentencesOf(const ClusteredUncertainty& clustered);

/// One camera: lens, pose in the rig, used and unused data.
struct CameraResult {
  std::string name, file, model;  ///< file: CameraData::file; model: Model::name
  std::vector<Parameter> parameters;
  Eigen::Matrix3d camera_matrix;
  std::vector<double> distortion;  ///< in OpenCV's order: k1 k2 p1 p2 k3 [k4 k5 k6]; fisheye: k1 k2 k3 k4
  SE3 left2camera;  ///< from the reference camera; the identity for the reference camera itself
  vec3 translation_std = vec3(unknown, unknown, unknown);  ///< [m]
  vec3 rotation_std = vec3(unknown, unknown, unknown);     ///< about the axes of the reference camera [rad]
  /// Standard deviations of the components of log(rotation) [rad].
  vec3 rotation_vector_std = vec3(unknown, unknown, unknown);
  ClusteredVector translation_clustered, rotation_clustered, rotation_vector_clustered;
  std::size_t images = 0, corners = 0;
  double rms_px = 0;               ///< sqrt(sum of squared corner distances / corners)
  double rms_px_single = unknown;  ///< RMS of the fit of this camera without the others, if it converged
  std::optional<ImageSize> image_size;
  int board_symmetry = 1;           ///< CameraData::board_symmetry
  std::vector<UnusedPhoto> unused;  ///< photographs that show no board, cannot be read, or have another size
  std::vector<Copy> copies;         ///< views that repeat others
  std::vector<Exclusion> excluded;  ///< CameraData::excluded
  CornerNoise noise;                ///< noise of the corners (Settings::sigma_by)
  std::optional<Readout> readout;   ///< present if it was requested and corners are known to move

  /// Returns the pixel of a point in this camera's frame [m]; NaN if it has none.
  vec2 project(const vec3& point) const;
  /// Returns the direction, of length 1, that a pixel sees; nothing if there is none, such as beyond a fold of the
  /// model.
  std::optional<vec3> ray(const vec2& pixel) const;
};

/// Largest standard deviations of the axes; 0 for fixed values.
struct ImuPrecision {
  double rotation = unknown;  ///< [rad]
  double acc_bias = unknown;  ///< [m/s^2]
  double gravity = unknown;   ///< [m/s^2]
};

/// The accelerometer: rotation to the reference camera, bias, gravity.
struct ImuResult {
  std::string file;
  std::size_t readings = 0;
  SO3 left2imu;
  vec3 rotation_std = vec3(unknown, unknown, unknown);  ///< about the axes of the reference camera [rad]
  /// Standard deviations of the components of log(rotation) [rad].
  vec3 rotation_vector_std = vec3(unknown, unknown, unknown);
  ClusteredVector rotation_clustered, rotation_vector_clustered;
  vec3 acc_bias;  ///< [m/s^2]
  vec3 acc_bias_std = vec3(unknown, unknown, unknown);
  ClusteredVector acc_bias_clustered;
  double gravity = 0, gravity_std = unknown;  ///< with sign [m/s^2]
  double gravity_std_clustered = unknown, gravity_dof = unknown;
  double rms_acc = 0;  ///< sqrt(sum of squared differences / readings) [m/s^2]
  bool acc_bias_is_fixed = false, gravity_is_fixed = false;
  ImuPrecision precision, if_gravity_fixed, if_acc_bias_fixed;
  double tilt_spread = 0;  ///< root mean square angle of "up" from its mean [rad]
  /// Sum of squared misfits with the other sign of gravity minus that with the chosen sign, in units of sigma_acc^2.
  double sign_evidence = 0;
  /// Whether the boards lie level below the cameras, so that the direction of readings at rest is known. If so, up_by_z
  /// is 1 if the readings point along the world's z axis, and -1 if they point against it.
  bool up_is_known = false;
  int up_by_z = 1;
  bool reads_gravity = false;  ///< Settings::imu_reads_gravity
};

/// The corner of an image with the largest residual.
struct WorstCorner {
  std::size_t camera = 0;  ///< index into Result::cameras
  int number = 0, line = 0;
  double error_px = 0;
  std::string place{};  ///< CameraData::place
};

/// One image: pose of the reference camera, and residuals.
struct ImageResult {
  int image = 0;
  SE3 left2world;
  std::vector<std::optional<double>> rms_px;  ///< by camera; nothing if the camera did not see the image
  std::optional<double> acc_error;            ///< length of (reading - prediction) [m/s^2]
  double chi2 = 0;                            ///< sum of squared whitened residuals
  int measurements = 0;                       ///< scalar residuals
  WorstCorner worst_corner;

  /// Returns chi2 per scalar residual, near 1 if the stated sigmas are right.
  double chi2PerMeasurement() const { return chi2 / measurements; }
};

/// A corner that the other corners contradict. The fit follows a corner with a large leverage, at the border of the
/// image, so its residual is small. Therefore the prediction of the fit without the corner counts.
struct GrossCorner {
  std::size_t camera = 0;
  int image = 0, number = 0, line = 0;
  double error_px = 0;          ///< residual of the corner
  double error_without_px = 0;  ///< residual with respect to the fit without the corner, to first order
  /// Residual divided by its own standard deviation, from the noise that most corners of all images show, or from its
  /// own noise if that is larger.
  double studentised = 0;
  std::string place{};  ///< CameraData::place
};

/// A view that fits neither the start values of the rig (the consensus of all common images) nor the calibration, if
/// there is one.
struct Stray {
  std::string camera;
  int image = 0;
  double error_px = 0;  ///< root mean square distance of its corners before the fit of the rig
  std::string photo{};  ///< if known
  /// True if the values were computed without the view. `error_px` is then for its best pose with the estimated lens.
  bool is_left_out = false;
  /// True if the view has the other handedness than most views of its camera. `error_px` may then be small.
  bool is_mirrored = false;
  std::string why{};  ///< a clause if the cause is known: "corners disagree by 40 px ..."
  double size = 1;    ///< size of its image relative to the others, if that is the cause
};

/// A model that fits the corners of a calibration much better than the chosen model.
struct BetterModel {
  std::string name;   ///< Model::name
  double rms_px = 0;  ///< over all corners
};

/// A calibration: the values found, the end of the fit, and the data that it did not use.
struct Result {
  bool converged = false;
  std::string stop_reason;  ///< as in slom::toString
  std::string message;      ///< sentence of slom::Summary on the stop
  int iterations = 0;
  int measurements = 0, unknowns = 0, redundancy = 0;
  double rss = 0;
  double sigma_px = 0, sigma_acc = 0;
  std::optional<double> sigma_denominator;  ///< Settings::sigma_denominator
  std::vector<std::string> active_bounds;   ///< `left.k3 is at its upper bound 1`
  std::string undetermined;                 ///< empty, or why there are no standard deviations
  std::vector<CameraResult> cameras;
  std::optional<ImuResult> imu;
  std::optional<FittedBoard> board;               ///< of a bent or free board (Settings::board_shape)
  std::optional<ClusteredUncertainty> clustered;  ///< of a successful calibration from at least two images
  std::vector<Stray> strays;
  /// Searched for if corners are off by more than detection explains, or if the fit failed.
  std::optional<BetterModel> better_model;
  /// For such a fit: the most likely cause of the failure, with the number that shows it and the remedy, or the
  /// excluded causes; a clause each.
  std::vector<std::string> causes;
  /// Corners that the fit does not use (Settings::robust), and where the fit puts them; the worst first.
  std::vector<GrossCorner> rejected;
  std::optional<Downweighted> downweighted;         ///< effect of a loss on the corners
  std::vector<GrossCorner> gross;                   ///< of a successful calibration, the worst first
  std::vector<ImageResult> images;                  ///< by rising number
  std::optional<Comparison> comparison;             ///< if requested
  std::optional<Comparison> board_comparison;       ///< of shapes of the board, if requested
  std::optional<NoiseComparison> noise_comparison;  ///< of what the noise grows with, if requested
  /// Comparison of rolling shutters, by camera, if requested; otherwise empty.
  std::vector<std::optional<ReadoutTrial>> readout_comparison;
  std::optional<Quality> quality;  ///< if requested

  /// Returns RSS / redundancy, near 1 if the stated sigmas are right; NaN without redundancy.
  double chi2PerDof() const { return redundancy > 0 ? rss / redundancy : unknown; }
  /// Returns whether the fit has converged and the data determine all values.
  bool success() const { return converged && undetermined.empty(); }
  /// Removes all standard deviations; why: for `undetermined`.
  void declareUndetermined(std::string why);
  /// Returns the `count` images with the largest chi2 per measurement, the worst first.
  std::vector<const ImageResult*> worstImages(std::size_t count) const;
};

}  // namespace slom::calibration
