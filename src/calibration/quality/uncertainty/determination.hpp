// How well the boards of a camera alone determine its focal length and centre.
#pragma once

#include <Eigen/Core>

#include "calibration/models/lens.hpp"
#include "slom/calibration/dataset.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// Standard deviations of the lens on its optical axis, for any model.
struct AxisUncertainty {
  double focal = unknown;      ///< of the scale of the image, relative; the larger of u and v
  double centre_px = unknown;  ///< of the pixel of the axis, the larger of u and v [px]
};

/// Propagates `covariance`, of the lens parameters, to the axis: first order, by central differences of the exact
/// derivatives.
AxisUncertainty axisUncertainty(const Lens& lens, const Eigen::MatrixXd& covariance);

/// Returns the largest angle between the normal of a board and the mean normal of all boards that camera `c` sees, in
/// the frame of the camera [rad].
double tiltSpreadOf(const Dataset& data, const Result& result, std::size_t c);

}  // namespace slom::calibration
