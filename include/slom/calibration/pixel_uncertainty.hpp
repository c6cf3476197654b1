/// How sure it is where a calibrated camera sees a point, asked pixel by pixel.
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

  /// 2 x 2 [px^2].
  Eigen::Matrix2d matrix() const { return Eigen::Matrix2d{{uu, uv}, {uv, vv}}; }
  /// The standard deviation in the direction in which it is largest [px].
  double largestStd() const;
};

/// A point that stands still before the rig is seen in a pixel. A calibration from other images of the same boards would project it to
/// another one: how far away, to first order, is the projection uncertainty. It includes what the lens, the pose in the rig and
/// the frame of the calibration leave open, and no error of the images to come. It is for errors that images share (Result::clustered), where there are images enough, and as stated
/// otherwise. `Quality` holds the same over a grid.
///   source   mrcal, https://mrcal.secretsauce.net/uncertainty.html
class PixelUncertainty {
 public:
  /// Takes time proportional to the corners. `result` is calibrate(data, settings). Throws DataError
  /// [slom.calibration.no-result] where the result did not succeed or is of other cameras or images.
  PixelUncertainty(const Dataset& data, const Result& result);

  /// The covariance of the image of the point that is seen at `pixel` in camera `camera`, an index into Result::cameras, at this distance from the
  /// camera [m]; infinite: of a direction. Nothing where the model has no ray for the pixel. Throws DataError [slom.calibration.bad-question] for
  /// a camera that is not there, a pixel that is not finite or a distance that is not positive. May be called by several threads.
  std::optional<PixelCovariance> at(std::size_t camera, const vec2& pixel,
                                    double distance_m = std::numeric_limits<double>::infinity()) const;

 private:
  struct Implementation;
  std::shared_ptr<const Implementation> impl_;
};

}  // namespace slom::calibration
