/// How far a calibration can be trusted, as plain numbers: what the report and the JSON show beyond parameters
/// and their standard deviations.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "slom/calibration/patterns.hpp"
#include "slom/calibration/types.hpp"

namespace slom::calibration {

/// The part of the plane that a camera's images cover, from (0, 0) to the last pixel [px].
struct ImageBox {
  int width = 0, height = 0;
  bool is_assumed = false;  ///< the image size was not given
};

/// Nodes that lie evenly over an image, the outer ones on its border; row by row from the top left.
struct ImageGrid {
  int columns = 0, rows = 0;
  ImageBox box;

  /// The number of nodes.
  int size() const { return columns * rows; }
  /// Where node i is [px].
  vec2 node(int i) const {
    return vec2((box.width - 1.0) * (i % columns) / (columns - 1),
                (box.height - 1.0) * (i / columns) / (rows - 1));
  }
  /// The node at the centre of the image.
  int middle() const { return rows / 2 * columns + columns / 2; }
};

/// The residual of one corner.
struct CornerResidual {
  int image = 0, corner = 0, line = 0;
  vec2 pixel;     ///< where it was found
  vec2 residual;  ///< found less predicted [px]
};

/// Where a point that stands still before the rig is projected to: standard deviation in the direction in
/// which it is largest, by node of the grid [px]; NaN where no ray is known to lead to the pixel.
struct ProjectionUncertainty {
  double distance_m = std::numeric_limits<double>::infinity();
  std::vector<double> std_px;
  double middle_px = 0, median_px = 0, worst_px = 0;
};

/// Two calibrations, each from every second image: where they project the same ray to.
struct SplitHalfCamera {
  std::vector<double> difference_px;  ///< by node of the grid; NaN where one of them has no ray for the pixel
  double rms_px = 0, largest_px = 0;
  double expected_rms_px = 0;  ///< what noise of the stated sigma alone gives
  double chi2 = 0;             ///< chi-square of the difference of the lens parameters
  int dof = 0;
  double probability = 1;  ///< that noise alone gives such a chi2 or a larger one
};

/// The calibration from every second image against that from the others.
struct SplitHalf {
  std::string why_not;  ///< empty, or why there is none
  std::vector<SplitHalfCamera> cameras;
};

/// Residuals and projection uncertainty of one camera.
struct CameraQuality {
  ImageGrid grid;
  std::vector<CornerResidual> residuals;          ///< by image, then as in the file
  std::vector<ProjectionUncertainty> projection;  ///< at the distance of the boards, and at infinity
  std::vector<ProjectionUncertainty>
      projection_stated;  ///< the same for errors that are independent, as stated
  std::vector<double> distances_m, middle_px, worst_px;  ///< how it depends on the distance
  /// Standard deviation of the scale of the image on the optical axis, as a part of it: that of the focal length, whatever the model's parameters are.
  double focal_std = std::numeric_limits<double>::quiet_NaN();
  double centre_std_px = std::numeric_limits<double>::quiet_NaN();  ///< of the pixel of the optical axis [px]
  double tilt_spread =
      std::numeric_limits<double>::quiet_NaN();  ///< largest angle between a board and the mean of all [rad]
};

/// Between the parameters that all images share.
struct Correlations {
  /// Two parameters and their correlation, from -1 to 1.
  struct Pair {
    std::string a, b;
    double coefficient = 0;
  };
  std::vector<std::string> names;
  std::vector<double> matrix;  ///< symmetric, 1 on the diagonal, row by row; estimated parameters alone
  std::vector<Pair> strong;    ///< the largest by magnitude, from 0.9 on

  /// The number of parameters.
  std::size_t size() const { return names.size(); }
  /// The correlation of parameters i and j.
  double coefficient(std::size_t i, std::size_t j) const { return matrix[i * size() + j]; }
};

/// A board that is not there yet, and what it would bring.
struct FurtherView {
  std::size_t camera = 0;
  vec2 pixel;               ///< image of its centre in that camera
  int column = 0, row = 0;  ///< third of the image, from the top left
  double tilt_deg = 0;      ///< against the image plane
  std::string
      edge_away;  ///< which edge of the board is farther away: left, right, upper, lower; empty if none
  double distance_m = 0;
  double before_px = 0, after_px = 0;  ///< worst projection uncertainty of points at `of_distance_m`
  SE3 left2world;
  double of_distance_m =
      0;  ///< the distance of the boards, or infinity where that is what the images leave open
};

/// One of the corners with the largest residuals.
struct WorstResidual {
  std::size_t camera = 0;
  CornerResidual corner;
  double error_px = 0;
  std::string place{};  ///< CameraData::place
};

/// How long a part of the assessment took.
struct PhaseTime {
  std::string phase;
  double seconds = 0;
};

/// Everything after `worst` exists for a calibration that succeeded, as far as there was time.
struct Quality {
  std::vector<CameraQuality> cameras;
  /// Projection uncertainty and further views are those of errors that images share (Result::clustered), as is what halves may differ by where
  /// each has images enough; otherwise all are those of the stated sigmas.
  bool is_clustered = false;
  std::vector<WorstResidual> worst;  ///< the worst first
  double board_distance_m = 0;  ///< median distance of the boards' centres from the cameras that saw them
  /// What residuals have in common; of cameras with at least nine images, found or not.
  std::vector<ResidualPattern> patterns;
  SplitHalf split_half;
  Correlations correlations;
  std::vector<FurtherView> further_views;  ///< one after the other: each with those before it added
  std::vector<PhaseTime> times;
  std::string cut_short{};  ///< empty, or why something is missing: `time limit of 5 s reached`

  /// Whether the projection uncertainty is there.
  bool hasProjection() const { return !cameras.empty() && !cameras.back().projection.empty(); }
};

}  // namespace slom::calibration
