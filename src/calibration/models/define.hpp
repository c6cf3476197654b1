// Makes an entry of the list of models from a camera type (models/camera.hpp). Included by the file of each model alone: what
// it instantiates takes long to compile.
#pragma once

#include "calibration/fit/calibrate_model.hpp"
#include "calibration/models/definition.hpp"
#include "calibration/quality/uncertainty/model_lens.hpp"

namespace slom::calibration {

template <class Camera>
Camera cameraOf(const std::vector<double>& parameters) {
  Camera camera;
  for (int i = 0; i < Camera::DOF; ++i) camera[i] = parameters.at(std::size_t(i));
  return camera;
}

template <class Camera>
ModelDefinition defineModel() {
  ModelDefinition model;
  model.name = Camera::model_name;
  model.parameters.assign(Camera::component_names.begin(), Camera::component_names.end());
  if constexpr (has_prior<Camera>)
    model.held_near_zero.assign(Camera::held_near_zero.begin(), Camera::held_near_zero.end());
  model.is_compared = true;
  if constexpr (requires { Camera::is_compared; }) model.is_compared = Camera::is_compared;
  model.calibrate = calibrateModel<Camera>;
  model.calibrate_from = calibrateModelFrom<Camera>;
  model.try_model = tryModel<Camera>;
  model.make_lens = [](const std::vector<double>& parameters) -> std::unique_ptr<Lens> {
    return std::make_unique<ModelLens<Camera>>(cameraOf<Camera>(parameters));
  };
  model.for_opencv = [](const std::vector<double>& parameters) {
    return cameraOf<Camera>(parameters).forOpencv();
  };
  model.for_ros = [](const std::vector<double>& parameters) { return cameraOf<Camera>(parameters).forRos(); };
  model.for_kalibr = [](const std::vector<double>& parameters) {
    return cameraOf<Camera>(parameters).forKalibr();
  };
  return model;
}

}  // namespace slom::calibration

/// Defines what the line of models/list.inc of this name refers to.
#define SLOM_CALIBRATION_DEFINE_MODEL(name, Camera)         \
  namespace slom::calibration::models {                     \
  const ModelDefinition& name() {                           \
    static const auto definition = defineModel<Camera<>>(); \
    return definition;                                      \
  }                                                         \
  }
