// The lens of a calibrated camera, whatever its model is: where it projects points to, and the ray of a
// pixel.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "slom/calibration/result.hpp"

namespace slom::calibration {

class Lens {
 public:
  /// A pixel and how it changes with the point (2 x 3, [px/m]).
  struct PointProjection {
    vec2 pixel;
    Eigen::Matrix<double, 2, 3> by_point;
  };
  /// And with the lens parameters (2 x n).
  struct Projection : PointProjection {
    Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::ColMajor, 2, 12> by_parameters;
  };

  virtual ~Lens() = default;
  virtual int parameters() const = 0;
  virtual vec2 project(const vec3& point) const = 0;
  virtual Projection differentiate(const vec3& point) const = 0;
  virtual PointProjection differentiateByPoint(const vec3& point) const = 0;
  /// J^T J of the pixels of points in the world, J by the parameters and by left2camera (translation,
  /// rotation) [px]; its rows over the sigma of their points, where these are given.
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 18, 18>;
  virtual Square square(const SE3& left2camera, const SE3& left2world, const std::vector<vec3>& points,
                        const std::vector<double>& sigmas) const = 0;

  /// The direction, of length 1, that is projected to a pixel. Found by walking there from a ray whose pixel
  /// is known to have one, the optical axis; nothing where the model folds over on the way, as distortion
  /// polynomials do outside of the corners that they were fitted to.
  std::optional<vec3> unproject(const vec2& pixel, vec3 from = vec3(0., 0., 1.)) const;

 protected:
  double scale_ = 0;  ///< scale of the image about the optical axis [px/rad]
  double least_z_ =
      1e-3;  ///< of the rays of length 1 that the model is for: above 0 for a pinhole, near -1 for one of angles
};

std::unique_ptr<Lens> makeLens(const CameraResult& camera);

}  // namespace slom::calibration
