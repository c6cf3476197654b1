// The size of the images of a camera, assumed if it is not stated.
#pragma once

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/quality.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// Returns the stated size, or assumes one: a common size that has room for all corners and has the optical axis near
/// its centre. If there is none, assumes the smallest size that has room for all corners and twice the coordinates of
/// the axis.
ImageBox imageBoxOf(const CameraData& data, const CameraResult& camera);

}  // namespace slom::calibration
