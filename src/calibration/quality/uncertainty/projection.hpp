// Uncertainty of the projection of points, over the image.
//
// A point at rest relative to the rig has a pixel and a distance. Another sample of the noise gives other lenses and
// poses, and another frame of the rig, and so projects the point to another pixel. To first order, the standard
// deviation of this change is the projection uncertainty. It is small where corners were seen, and grows where the
// lens was extrapolated.
//   source   mrcal, https://mrcal.secretsauce.net/uncertainty.html
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "calibration/quality/uncertainty/information.hpp"
#include "slom/calibration/pixel_uncertainty.hpp"
#include "slom/calibration/quality.hpp"

namespace slom::calibration {

/// The point at a pixel of the image, and derivatives of its projection by the shared parameters and by the motion of
/// the frame. Holds no posterior, so that one point serves for several posteriors.
struct ProjectedPoint {
  Eigen::Matrix<double, 2, Eigen::Dynamic> by_shared;  ///< with the frame fixed
  Eigen::Matrix<double, 2, 6> by_motion;               ///< motion of the frame: translation, rotation

  /// Returns the 2 x 2 covariance of the pixel [px^2].
  Eigen::Matrix2d covariance(const Posterior& posterior) const;
};

/// Derivatives of a point's pixel along one direction of the image.
struct DirectedPoint {
  Eigen::RowVectorXd by_shared;
  Eigen::Matrix<double, 1, 6> by_motion;
};

/// Many projected points, which is faster than one by one.
class ProjectedPoints {
 public:
  ProjectedPoints() = default;
  explicit ProjectedPoints(const std::vector<ProjectedPoint>& points);
  std::size_t size() const { return std::size_t(by_shared_.rows() / 2); }
  /// Returns the standard deviation of each point, in the direction in which it is largest [px].
  std::vector<double> std(const Posterior& posterior) const;
  /// Returns point i along the direction in which its standard deviation is largest.
  DirectedPoint alongLargest(std::size_t i, const Posterior& posterior) const;
  /// Returns the points `which`, in that order.
  ProjectedPoints at(const std::vector<std::size_t>& which) const;

 private:
  Eigen::MatrixXd by_shared_, by_motion_;  // two rows for each point
};

/// The posterior for points on rays of one camera, at any distance. Their pixels depend on three quantities only: the
/// lens parameters p, the turn t of the frame against the camera, and the shift s, both as the camera sees them. The
/// pixel of distance * ray changes by
///   by_parameters dp + by_turn(ray) dt + by_point(ray) ds / distance
class CameraPosterior {
 public:
  CameraPosterior(const FittedRig& rig, const Posterior& posterior, std::size_t c);
  /// Returns the covariance of the pixel of distance * ray; the distance may be infinite.
  PixelCovariance covarianceAt(const vec3& ray, double distance_m) const {
    return spreadOf(ray).at(distance_m);
  }
  /// Returns standard deviations of the pixels of the rays that are present, at infinity [px].
  std::vector<double> stdOfRays(const std::vector<std::optional<vec3>>& rays) const;
  /// Returns maps over a grid with these rays, at distances that may be infinite. If no node has a ray, the maps have
  /// no summary figures.
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

/// Returns the projected point on a ray of camera c. `ray` has length 1. For an infinite distance only directions
/// count.
ProjectedPoint projectedPoint(const FittedRig& rig, std::size_t c, const vec3& ray, double distance_m);

/// Returns the rays of all nodes of a grid, in the camera.
std::vector<std::optional<vec3>> raysOf(const Lens& lens, const ImageGrid& grid);

/// Returns the largest standard deviation in any direction, from variances and covariance of u and v.
double largestStd(double uu, double uv, double vv);

}  // namespace slom::calibration
