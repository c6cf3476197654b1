// The whole way from data to result.
#pragma once

#include <functional>

#include <slom/slom.hpp>

#include "calibrate/input/dataset.hpp"
#include "calibrate/result.hpp"

namespace slom::app::calib {

/// What happened with one camera before the joint fit.
struct AloneReport {
  const CameraData* camera;
  std::string start;  ///< how the intrinsics were found
  bool converged;
  int iterations;
  double rms_px;
};

/// Called on the way; each may be empty.
struct Progress {
  std::function<void(const AloneReport&)> alone;
  std::function<void(const IterationRecord&)> iteration;
};

/// The functions below for one of the camera models, from data that were checked. Defined in calibrate_model.hpp.
template <class Camera>
Result calibrateModel(const Dataset& data, const Settings& settings, const Progress& progress);
template <class Camera>
Result calibrateModelFrom(const Result& start, const Dataset& data, const Settings& settings);

/// Start values, each camera alone, then all together. UserError when the data cannot determine the model.
Result calibrate(const Dataset& data, const Settings& settings, const Progress& progress = {});

/// The joint fit alone, of images that are among those of an earlier result, from the values found there. An IMU is left
/// out.
Result calibrateFrom(const Result& start, const Dataset& data, const Settings& settings);

}  // namespace slom::app::calib
