// How well the boards of a camera determine its focal length and centre by themselves.
#pragma once

#include <Eigen/Core>

#include "calibration/models/lens.hpp"
#include "slom/calibration/dataset.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// Standard deviations of the lens on its optical axis, whatever the parameters of its model are.
struct AxisUncertainty {
  double focal =
      unknown;  ///< of the scale of the image, in u or v where it is larger, as a part of the scale
  double centre_px = unknown;  ///< of the pixel of the axis, in u or v where it is larger [px]
};

/// Propagates `covariance`, that of the lens parameters, to the axis: first order, central differences of the exact derivatives.
AxisUncertainty axisUncertainty(const Lens& lens, const Eigen::MatrixXd& covariance);

/// Returns the largest angle between the normal of a board and the mean normal of all boards that camera `c` sees, in the frame of
/// the camera [rad].
double tiltSpreadOf(const Dataset& data, const Result& result, std::size_t c);

}  // namespace slom::calibration
