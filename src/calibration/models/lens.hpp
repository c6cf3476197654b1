// The lens of a camera of any model: its parameters and its projection. A variable of the fits.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <mtk/mtk.hpp>

#include "slom/calibration/models.hpp"
#include "slom/calibration/types.hpp"

namespace slom::calibration {

struct CameraResult;

class Lens : public mtk::vect<mtk::Dynamic> {
 public:
  static constexpr int most_parameters = 12;

  /// A pixel and its derivatives by the point (2 x 3, [px/m]).
  struct PointProjection {
    vec2 pixel;
    Eigen::Matrix<double, 2, 3> by_point;
  };
  /// A pixel with derivatives also by the lens parameters (2 x n).
  struct Projection : PointProjection {
    Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::ColMajor, 2, most_parameters> by_parameters;
  };

  /// Makes a lens. `parameters` has all parameters of the model, in their order.
  Lens(const Model& model, const std::vector<double>& parameters);

  const Model& model() const { return model_; }
  int parameters() const { return int(size()); }
  std::vector<double> numbers() const { return {begin(), end()}; }
  /// Returns the names of the model's parameters, for the estimator.
  const std::vector<std::string>& componentNames() const { return model_.parameters(); }

  /// Returns the pixel [px] of a point in the frame of the camera [m]; NaN for a point without an image.
  vec2 project(const vec3& point) const;
  Projection differentiate(const Eigen::Vector3d& point) const;
  /// Returns the direction, of length 1, that is projected to a pixel. Steps towards it from `from`, whose pixel must
  /// have a direction. Returns nothing if the model folds over on the way, as distortion polynomials do outside the
  /// corners of their fit.
  std::optional<vec3> unproject(const vec2& pixel, vec3 from = vec3(0., 0., 1.)) const;

 private:
  Model model_;
};

/// Returns the lens of a calibrated camera. Throws [slom.calibration.bad-camera] if model and parameters do not fit.
Lens lensOf(const CameraResult& camera);

}  // namespace slom::calibration
