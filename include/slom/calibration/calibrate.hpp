/// The whole way from data to result.
#pragma once

#include <functional>

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/result.hpp"
#include "slom/optimize/summary.hpp"

namespace slom::calibration {

/// What happened with a single camera before the fit of the rig.
struct SingleCameraReport {
  const CameraData* camera;
  std::string start;  ///< how the intrinsics were found
  bool converged;
  int iterations;
  double rms_px;
};

/// Called on the way; each may be empty.
struct Progress {
  std::function<void(const SingleCameraReport&)> single_camera;
  std::function<void(const IterationRecord&)> iteration;
};

/// Start values, fits of single cameras, then the fit of the rig. DataError when settings or data
/// make no sense or cannot determine the model; a fit that did not converge is a result that says so.
Result calibrate(const Dataset& data, const Settings& settings, const Progress& progress = {});

}  // namespace slom::calibration
