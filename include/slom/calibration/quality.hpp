/// Quality: figures on how far a calibration can be trusted. Report and JSON show them in addition to parameters and
/// their standard deviations.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "slom/calibration/patterns.hpp"
#include "slom/calibration/types.hpp"

namespace slom::calibration {

/// The area of a camera's images, from (0, 0) to the last pixel [px].
struct ImageBox {
  int width = 0, height = 0;
  bool is_assumed = false;  ///< the image size was not given
};

/// Nodes spaced evenly over an image, the outer ones on its border; row by row from the top left.
struct ImageGrid {
  int columns = 0, rows = 0;
  ImageBox box;

  /// Returns the number of nodes.
  int size() const { return columns * rows; }
  /// Returns the position of node i [px].
  vec2 node(int i) const {
    return vec2((box.width - 1.0) * (i % columns) / (columns - 1),
                (box.height - 1.0) * (i / columns) / (rows - 1));
  }
  /// Returns the node at the centre of the image.
  int middle() const { return rows / 2 * columns + columns / 2; }
};

/// The residual of one corner.
struct CornerResidual {
  int image = 0, corner = 0, line = 0;
  vec2 pixel;     ///< detected position
  vec2 residual;  ///< detected minus predicted position [px]
};

/// Uncertainty of the projection of a fixed point in front of the rig: standard deviation in the direction in which it
/// is largest, for each node of the grid [px]. NaN if the model has no ray for the pixel.
struct ProjectionUncertainty {
  double distance_m = std::numeric_limits<double>::infinity();
  std::vector<double> std_px;
  double middle_px = 0, median_px = 0, worst_px = 0;
};

/// Comparison of two calibrations, each from every second image: where do they project the same ray?
struct SplitHalfCamera {
  /// Difference for each node of the grid; NaN if one calibration has no ray for the pixel.
  std::vector<double> difference_px;
  double rms_px = 0, largest_px = 0;
  double expected_rms_px = 0;  ///< value for noise of the stated sigma alone
  double chi2 = 0;             ///< chi-square of the difference of the lens parameters
  int dof = 0;
  double probability = 1;  ///< p-value: that noise alone gives a chi2 at least as large
};

/// The calibration from every second image, compared with that from the other images.
struct SplitHalf {
  std::string why_not;  ///< empty, or the reason why there is none
  std::vector<SplitHalfCamera> cameras;
};

/// Residuals and projection uncertainty of one camera.
struct CameraQuality {
  ImageGrid grid;
  std::vector<CornerResidual> residuals;          ///< by image, then as in the file
  std::vector<ProjectionUncertainty> projection;  ///< at the distance of the boards, and at infinity
  /// Projection uncertainty for independent errors, as stated.
  std::vector<ProjectionUncertainty> projection_stated;
  std::vector<double> distances_m, middle_px, worst_px;  ///< dependence on the distance
  /// Relative standard deviation of the focal length, defined for every model as the image scale on the optical axis.
  double focal_std = std::numeric_limits<double>::quiet_NaN();
  double centre_std_px = std::numeric_limits<double>::quiet_NaN();  ///< of the pixel on the optical axis [px]
  /// Largest angle between a board and the mean of all boards [rad].
  double tilt_spread = std::numeric_limits<double>::quiet_NaN();
};

/// Correlations between the parameters that all images share.
struct Correlations {
  /// Two parameters and their correlation, from -1 to 1.
  struct Pair {
    std::string a, b;
    double coefficient = 0;
  };
  std::vector<std::string> names;
  std::vector<double> matrix;  ///< symmetric, 1 on the diagonal, row by row; only estimated parameters
  std::vector<Pair> strong;    ///< the largest by magnitude, from 0.9 on

  /// Returns the number of parameters.
  std::size_t size() const { return names.size(); }
  /// Returns the correlation of parameters i and j.
  double coefficient(std::size_t i, std::size_t j) const { return matrix[i * size() + j]; }
};

/// A proposed board, and how much it would help.
struct FurtherView {
  std::size_t camera = 0;
  vec2 pixel;               ///< image of its centre in that camera
  int column = 0, row = 0;  ///< third of the image, from the top left
  double tilt_deg = 0;      ///< relative to the image plane
  /// The edge of the board that is farther away: left, right, upper or lower; empty if none.
  std::string edge_away;
  double distance_m = 0;
  double before_px = 0, after_px = 0;  ///< worst projection uncertainty of points at `of_distance_m`
  SE3 left2world;
  /// The distance of the boards, or infinity if the images leave that distance most uncertain.
  double of_distance_m = 0;
};

/// One of the corners with the largest residuals.
struct WorstResidual {
  std::size_t camera = 0;
  CornerResidual corner;
  double error_px = 0;
  std::string place{};  ///< CameraData::place
};

/// Duration of a part of the assessment.
struct PhaseTime {
  std::string phase;
  double seconds = 0;
};

/// Figures of a calibration. Members after `worst` are filled if the calibration succeeded and as far as there was
/// time.
struct Quality {
  std::vector<CameraQuality> cameras;
  /// If true, projection uncertainty and further views are for errors that images share (Result::clustered). So is the
  /// expected difference of the halves, if each half has enough images. If false, all of these are for the stated
  /// sigmas.
  bool is_clustered = false;
  std::vector<WorstResidual> worst;  ///< the largest residual first
  double board_distance_m =
      0;  ///< median distance of the boards' centres from the cameras that observed them
  /// Patterns in the residuals of cameras with at least 9 images, whether found or not.
  std::vector<ResidualPattern> patterns;
  SplitHalf split_half;
  Correlations correlations;
  std::vector<FurtherView> further_views;  ///< each view assumes that those before it are added
  std::vector<PhaseTime> times;
  std::string cut_short{};  ///< empty, or why something is missing: `time limit of 5 s reached`

  /// Returns whether the projection uncertainty is available.
  bool hasProjection() const { return !cameras.empty() && !cameras.back().projection.empty(); }
};

}  // namespace slom::calibration
