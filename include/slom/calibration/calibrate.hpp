/// calibrate: from data to a result.
#pragma once

#include <functional>

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/result.hpp"
#include "slom/optimize/summary.hpp"

namespace slom::calibration {

/// Report on a single camera before the fit of the rig.
struct SingleCameraReport {
  const CameraData* camera;
  std::string start;  ///< how the intrinsics were found
  bool converged;
  int iterations;
  double rms_px;
};

/// Functions called during the calibration; each may be empty.
struct Progress {
  std::function<void(const SingleCameraReport&)> single_camera;
  std::function<void(const IterationRecord&)> iteration;
};

/// Finds start values, fits single cameras, then fits the rig. Throws DataError if settings or data are invalid or
/// cannot determine the model. If a fit does not converge, the result says so; nothing is thrown.
Result calibrate(const Dataset& data, const Settings& settings, const Progress& progress = {});

}  // namespace slom::calibration
