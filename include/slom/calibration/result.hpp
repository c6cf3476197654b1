/// What the calibration found, as plain numbers. It does not know where it is written, if anywhere.
/// Standard deviations are those of the stated sigmas, for errors that are independent; beside them, as `..._clustered`, those for errors
/// that the corners of an image, or of neighbouring images, share (ClusteredUncertainty). Both are 0 for what is fixed and NaN where the data
/// leave the value open (`undetermined` then says what).
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

/// A parameter of a lens: value and standard deviation in its own unit, px for focal lengths and centre.
struct Parameter {
  std::string name;
  double value = 0, std = unknown;
  double std_clustered = unknown;
  double dof = unknown;  ///< degrees of freedom of std_clustered
};

/// Standard deviations and their degrees of freedom for errors that images share.
struct ClusteredVector {
  vec3 std = vec3(unknown, unknown, unknown);
  vec3 dof = vec3(unknown, unknown, unknown);
};

/// How sure the parameters that all images share are where errors are dependent: in any way within an image and within blocks of images that
/// follow each other by number, and between images at the same corner of the board.
///   source   docs/decisions/clustered_uncertainty.md
struct ClusteredUncertainty {
  int images = 0;          ///< groups of the first way
  int board_points = 0;    ///< groups of the second way; 0: there are too few, and images alone count
  int block_length = 1;    ///< images that are taken together
  int blocks = 0;          ///< of so many images
  bool levels_off = true;  ///< otherwise errors are shared for longer than the longest blocks
  /// Factor of the standard deviations by which they exceed those of the longest blocks, where these do not level off; 1 where they
  /// do, and where there are too few images to say, and they are too small.
  double extrapolation = 1;
  /// Root mean square, over all directions of the parameters, of the clustered standard deviation over the stated one: by images, by blocks
  /// of them, and by blocks and points of the board.
  double ratio_by_image = unknown, ratio_by_block = unknown, ratio = unknown;
  /// Covariance of the parameters of the cameras, with the pose left2camera (translation, rotation) after those of each but the first
  /// one, then of the IMU's rotation, acc_bias and gravity; row by row.
  std::vector<double> covariance;

  /// With fewer images, projection uncertainty, halves and verdict stay with the stated standard deviations.
  static constexpr int fewest_images = 10;
  /// Whether there are enough images for the clustered standard deviations to replace the stated ones.
  bool isReliable() const { return images >= fewest_images; }
};

/// What limits these numbers, a sentence each: few images, errors that are shared for longer than can be seen, ...
std::vector<std::string> sentencesOf(const ClusteredUncertainty& clustered);

/// One camera: lens, pose in the rig, data used and left out.
struct CameraResult {
  std::string name, file, model;  ///< file: CameraData::file; model: Model::name
  std::vector<Parameter> parameters;
  Eigen::Matrix3d camera_matrix;
  std::vector<double> distortion;  ///< as OpenCV orders it: k1 k2 p1 p2 k3 [k4 k5 k6]; fisheye: k1 k2 k3 k4
  SE3 left2camera;                 ///< from the reference camera; the identity for that one
  vec3 translation_std = vec3(unknown, unknown, unknown);  ///< [m]
  vec3 rotation_std = vec3(unknown, unknown, unknown);     ///< about the axes of the reference camera [rad]
  vec3 rotation_vector_std =
      vec3(unknown, unknown, unknown);  ///< standard deviations of the components of log(rotation) [rad]
  ClusteredVector translation_clustered, rotation_clustered, rotation_vector_clustered;
  std::size_t images = 0, corners = 0;
  double rms_px = 0;               ///< sqrt(sum of squared corner distances / corners)
  double rms_px_single = unknown;  ///< RMS of the fit of this camera without the others, where it converged
  std::optional<ImageSize> image_size;
  int board_symmetry = 1;           ///< CameraData::board_symmetry
  std::vector<UnusedPhoto> unused;  ///< photographs that show no board, cannot be read, or have another size
  std::vector<Copy> copies;         ///< views that repeat others
  std::vector<Exclusion> excluded;  ///< CameraData::excluded
  CornerNoise noise;                ///< of its corners (Settings::sigma_by)
  std::optional<Readout> readout;   ///< where it was asked for and corners are known to move

  /// The pixel of a point in this camera's frame [m]; NaN where it has none.
  vec2 project(const vec3& point) const;
  /// The direction, of length 1, that is seen at a pixel; nothing where none is known to be, as beyond a fold of the model.
  std::optional<vec3> ray(const vec2& pixel) const;
};

/// Largest standard deviations of the axes; 0 for what is fixed.
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
  vec3 rotation_vector_std =
      vec3(unknown, unknown, unknown);  ///< standard deviations of the components of log(rotation) [rad]
  ClusteredVector rotation_clustered, rotation_vector_clustered;
  vec3 acc_bias;  ///< [m/s^2]
  vec3 acc_bias_std = vec3(unknown, unknown, unknown);
  ClusteredVector acc_bias_clustered;
  double gravity = 0, gravity_std = unknown;  ///< with sign [m/s^2]
  double gravity_std_clustered = unknown, gravity_dof = unknown;
  double rms_acc = 0;  ///< sqrt(sum of squared differences / readings) [m/s^2]
  bool acc_bias_is_fixed = false, gravity_is_fixed = false;
  ImuPrecision precision, if_gravity_fixed, if_acc_bias_fixed;
  double tilt_spread = 0;    ///< root mean square angle of "up" from its mean [rad]
  double sign_evidence = 0;  ///< ImuStart::sign_evidence
  /// Whether the boards lie level below the cameras, so that it is known where readings at rest point, and then 1 where along the world's z axis,
  /// -1 where against it.
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

/// One image: pose of the reference camera, and how well it fits.
struct ImageResult {
  int image = 0;
  SE3 left2world;
  std::vector<std::optional<double>> rms_px;  ///< by camera; nothing where it did not see the image
  std::optional<double> acc_error;            ///< length of the difference of the reading [m/s^2]
  double chi2 = 0;                            ///< sum of squared whitened residuals
  int measurements = 0;                       ///< scalar residuals
  WorstCorner worst_corner;

  /// chi2 per scalar residual: near 1 where the stated sigmas are right.
  double chi2PerMeasurement() const { return chi2 / measurements; }
};

/// A corner that the others contradict. The fit follows a corner with a large leverage, at the border of the image, so that its residual is
/// small; what counts is where the fit without it puts it.
struct GrossCorner {
  std::size_t camera = 0;
  int image = 0, number = 0, line = 0;
  double error_px = 0;          ///< its residual
  double error_without_px = 0;  ///< the same of the fit without it, to first order
  double studentised =
      0;  ///< residual over its own standard deviation, of the noise that most corners of all images show, or of its own where that is larger
  std::string place{};  ///< CameraData::place
};

/// A view that the start values of the rig, the consensus of all common images, do not fit, nor the calibration, if there is one.
struct Stray {
  std::string camera;
  int image = 0;
  double error_px = 0;  ///< root mean square distance of its corners before the fit of the rig
  std::string photo{};  ///< where it is known
  bool is_left_out =
      false;  ///< the values are those without it; `error_px` is then that of its best pose for the lens found
  bool is_mirrored =
      false;          ///< it has the other handedness than most views of its camera; `error_px` may be small
  std::string why{};  ///< a clause, where the cause is known: "its corners disagree by 40 px ..."
  double size = 1;    ///< of its image, over that of the others, where that is the cause
};

/// A model that fits the corners of a calibration much better than its own.
struct BetterModel {
  std::string name;   ///< Model::name
  double rms_px = 0;  ///< over all corners
};

/// A calibration: what was found, how the fit ended, and which data it did without.
struct Result {
  bool converged = false;
  std::string stop_reason;  ///< as slom::toString says it
  std::string message;      ///< the library's sentence on the stop
  int iterations = 0;
  int measurements = 0, unknowns = 0, redundancy = 0;
  double rss = 0;
  double sigma_px = 0, sigma_acc = 0;
  std::optional<double> sigma_denominator;  ///< Settings::sigma_denominator
  std::vector<std::string> active_bounds;   ///< `left.k3 is at its upper bound 1`
  std::string undetermined;                 ///< empty, or why there are no standard deviations
  std::vector<CameraResult> cameras;
  std::optional<ImuResult> imu;
  std::optional<FittedBoard> board;               ///< of a bent or free one (Settings::board_shape)
  std::optional<ClusteredUncertainty> clustered;  ///< of a calibration that succeeded, from two images on
  std::vector<Stray> strays;
  std::optional<BetterModel>
      better_model;  ///< asked for where corners are off by more than detection explains, or the fit failed
  /// Of such a fit: what it most likely fails by, with the number that shows it and the remedy, or which causes are excluded; a clause each.
  std::vector<std::string> causes;
  /// Corners that the fit does without (Settings::robust), and where it puts them; the worst first.
  std::vector<GrossCorner> rejected;
  std::optional<Downweighted> downweighted;         ///< what a loss made of the corners
  std::vector<GrossCorner> gross;                   ///< of a calibration that succeeded, the worst first
  std::vector<ImageResult> images;                  ///< by rising number
  std::optional<Comparison> comparison;             ///< where it was asked for
  std::optional<Comparison> board_comparison;       ///< of shapes of the board, likewise
  std::optional<NoiseComparison> noise_comparison;  ///< of what the noise grows with, likewise
  /// Of rolling shutters, by camera, likewise; empty where it was not asked for.
  std::vector<std::optional<ReadoutTrial>> readout_comparison;
  std::optional<Quality> quality;  ///< where it was asked for

  /// RSS / redundancy: near 1 where the stated sigmas are right. NaN without redundancy.
  double chi2PerDof() const { return redundancy > 0 ? rss / redundancy : unknown; }
  /// Whether the fit has converged and the data determine everything.
  bool success() const { return converged && undetermined.empty(); }
  /// Takes back all standard deviations; why: for `undetermined`.
  void declareUndetermined(std::string why);
  /// The `count` images with the largest chi2 per measurement, the worst first.
  std::vector<const ImageResult*> worstImages(std::size_t count) const;
};

}  // namespace slom::calibration
