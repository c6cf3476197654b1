/// PixelUncertainty: the uncertainty of the pixel where a calibrated camera sees a point, for any pixel.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>

#include <Eigen/Core>

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// The covariance of a pixel (u, v) [px^2].
struct PixelCovariance {
  double uu = 0, uv = 0, vv = 0;

  /// Returns the 2 x 2 matrix [px^2].
  Eigen::Matrix2d matrix() const { return Eigen::Matrix2d{{uu, uv}, {uv, vv}}; }
  /// Returns the standard deviation in the direction in which it is largest [px].
  double largestStd() const;
};

/// Projection uncertainty: a calibration from other images of the same boards would project a fixed point in front of
/// the rig to another pixel. The projection uncertainty is the standard deviation of this pixel, to first order. It
/// includes the uncertainty of the lens, of the pose in the rig and of the frame of the calibration, but no error of
/// future images. If there are enough images, it is for errors that images share (Result::clustered), otherwise for
/// the stated errors. `Quality` has it over a grid.
///   source   mrcal, https://mrcal.secretsauce.net/uncertainty.html
class PixelUncertainty {
 public:
  /// Prepares the queries. `result` must be calibrate(data, settings). Takes time proportional to the number of
  /// corners. Throws DataError [slom.calibration.no-result] if the result did not succeed or has other cameras or
  /// images.
  PixelUncertainty(const Dataset& data, const Result& result);

  /// Returns the covariance of the image of a point that camera `camera` sees at `pixel` and at this distance [m];
  /// infinite: a direction. `camera` is an index into Result::cameras. Returns nothing if the model has no ray for the
  /// pixel. Throws DataError [slom.calibration.bad-question] for a camera that does not exist, a pixel that is not
  /// finite or a distance that is not positive. Several threads may call it.
  std::optional<PixelCovariance> at(std::size_t camera, const vec2& pixel,
                                    double distance_m = std::numeric_limits<double>::infinity()) const;

 private:
  struct Implementation;
  std::shared_ptr<const Implementation> impl_;
};

}  // namespace slom::calibration
