// How sure it is where a point is projected to, over the image.
//
// A point that stands still before the rig is seen in a pixel at a distance. Another sample of the noise
// gives other lenses and poses, and another frame of the rig, and so projects it to another pixel: by how
// much, to first order, is the projection uncertainty. It is small where corners were seen, and grows where
// the lens was extrapolated.
//   source   mrcal, https://mrcal.secretsauce.net/uncertainty.html
#pragma once

#include <optional>
#include <vector>

#include "calibrate/quality/information.hpp"
#include "calibrate/quality/quality.hpp"

namespace slom::app::calib {

/// What a set of images knows, ready to be propagated.
struct Knowledge {
  explicit Knowledge(const Information& information);

  Eigen::MatrixXd shared;            ///< covariance of the shared parameters
  Eigen::MatrixXd motion_by_shared;  ///< 6 x shared
  Matrix6 motion_noise;
};

/// The point of the image at a pixel and how its projection moves with all of that; of no knowledge itself,
/// so that one can be asked about with several.
struct ProjectedPoint {
  Eigen::MatrixXd by_shared;              ///< 2 x shared, the frame held
  Eigen::Matrix<double, 2, 6> by_motion;  ///< of the frame: translation, rotation

  /// 2 x 2 [px^2].
  Eigen::Matrix2d covariance(const Knowledge& knowledge) const;
  /// In the direction in which it is largest [px].
  double std(const Knowledge& knowledge) const;
};

/// Many of them, which is quicker than one by one.
class ProjectedPoints {
 public:
  ProjectedPoints() = default;
  explicit ProjectedPoints(const std::vector<ProjectedPoint>& points);
  /// ProjectedPoint::std of each.
  std::vector<double> std(const Knowledge& knowledge) const;

 private:
  Eigen::MatrixXd by_shared_, by_motion_;  // two rows for each point
};

/// `ray`: direction of length 1 in camera c; `distance` may be infinite: then directions alone count.
ProjectedPoint projectedPoint(const FittedRig& rig, std::size_t c, const vec3& ray, double distance_m);

/// The rays of all nodes of a grid, in the camera.
std::vector<std::optional<vec3>> raysOf(const Lens& lens, const ImageGrid& grid);

/// Without summary figures where no node has a ray.
ProjectionUncertainty projectionUncertainty(const FittedRig& rig, const Knowledge& knowledge, std::size_t c,
                                            const ImageGrid& grid,
                                            const std::vector<std::optional<vec3>>& rays, double distance_m);

/// The largest standard deviation of a direction of a covariance.
double largestStd(const Eigen::Matrix2d& covariance);

}  // namespace slom::app::calib
