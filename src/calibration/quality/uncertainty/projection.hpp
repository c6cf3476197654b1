// How sure it is where a point is projected to, over the image.
//
// A point that stands still before the rig is seen in a pixel at a distance. Another sample of the noise
// gives other lenses and poses, and another frame of the rig, and so projects it to another pixel: by how
// much, to first order, is the projection uncertainty. It is small where corners were seen, and grows where
// the lens was extrapolated.
//   source   mrcal, https://mrcal.secretsauce.net/uncertainty.html
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "calibration/quality/uncertainty/information.hpp"
#include "slom/calibration/pixel_uncertainty.hpp"
#include "slom/calibration/quality.hpp"

namespace slom::calibration {

/// The point of the image at a pixel and how its projection moves with the shared parameters and with the frame. It has no posterior
/// of its own, so that one point serves for several.
struct ProjectedPoint {
  Eigen::Matrix<double, 2, Eigen::Dynamic> by_shared;  ///< with the frame fixed
  Eigen::Matrix<double, 2, 6> by_motion;               ///< motion of the frame: translation, rotation

  /// 2 x 2 [px^2].
  Eigen::Matrix2d covariance(const Posterior& posterior) const;
};

/// How a point's pixel moves along one direction of the image.
struct DirectedPoint {
  Eigen::RowVectorXd by_shared;
  Eigen::Matrix<double, 1, 6> by_motion;
};

/// Many of them, which is quicker than one by one.
class ProjectedPoints {
 public:
  ProjectedPoints() = default;
  explicit ProjectedPoints(const std::vector<ProjectedPoint>& points);
  std::size_t size() const { return std::size_t(by_shared_.rows() / 2); }
  /// Standard deviation of each, in the direction in which it is largest [px].
  std::vector<double> std(const Posterior& posterior) const;
  /// Point i along the direction in which its standard deviation is largest.
  DirectedPoint alongLargest(std::size_t i, const Posterior& posterior) const;
  /// Some of them, `which` one after the other.
  ProjectedPoints at(const std::vector<std::size_t>& which) const;

 private:
  Eigen::MatrixXd by_shared_, by_motion_;  // two rows for each point
};

/// Points on rays of one camera, at any distance. Of all that is known, little matters to them: with the lens parameters p,
/// and as the camera sees them, the turn t of the frame against it and the shift s, the pixel of distance * ray changes by
///   by_parameters dp + by_turn(ray) dt + by_point(ray) ds / distance
class CameraPosterior {
 public:
  CameraPosterior(const FittedRig& rig, const Posterior& posterior, std::size_t c);
  /// The covariance of the pixel of distance * ray; the distance may be infinite.
  PixelCovariance covarianceAt(const vec3& ray, double distance_m) const {
    return spreadOf(ray).at(distance_m);
  }
  /// Standard deviations of the pixels of the rays that are present, at infinity [px].
  std::vector<double> stdOfRays(const std::vector<std::optional<vec3>>& rays) const;
  /// Maps over a grid, whose rays these are, at distances that may be infinite. Without summary figures where no node has a ray.
  std::vector<ProjectionUncertainty> maps(const ImageGrid& grid, const std::vector<std::optional<vec3>>& rays,
                                          const std::vector<double>& distances_m) const;

 private:
  static constexpr int most = 12;  // parameters of a lens; with fewer, the last columns are 0
  /// The covariance of a pixel, far + mixed / distance + near / distance^2 [px^2].
  struct Spread {
    Eigen::Matrix2d far, mixed, near;
    PixelCovariance at(double distance_m) const;
  };
  Spread spreadOf(const vec3& ray) const;

  const Lens& lens_;
  Eigen::Matrix3d left2camera_;
  using Column = std::array<Eigen::Array4d, (most + 6 + 3) / 4>;  // in groups of four rows
  std::array<Column, most + 6> root_;  // upper triangle whose square is the covariance of (t, s, p)
};

/// `ray`: direction of length 1 in camera c; the distance may be infinite: then directions alone count.
ProjectedPoint projectedPoint(const FittedRig& rig, std::size_t c, const vec3& ray, double distance_m);

/// The rays of all nodes of a grid, in the camera.
std::vector<std::optional<vec3>> raysOf(const Lens& lens, const ImageGrid& grid);

/// The largest standard deviation of a direction, of variances and covariance of u and v.
double largestStd(double uu, double uv, double vv);

}  // namespace slom::calibration
