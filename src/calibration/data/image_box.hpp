// The size of the images of a camera, also if nothing states it.
#pragma once

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/quality.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// Returns the size as stated, or assumes one: a usual size that has room for all corners and the optical axis near its centre, or the smallest
/// that has both.
ImageBox imageBoxOf(const CameraData& data, const CameraResult& camera);

}  // namespace slom::calibration
