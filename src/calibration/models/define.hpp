// Makes an entry of the list of models from a camera type (models/camera.hpp). The file of each model includes this.
#pragma once

#include "calibration/models/definition.hpp"

namespace slom::calibration {

template <class Camera>
Camera cameraOf(const double* parameters) {
  Camera camera;
  for (int i = 0; i < Camera::DOF; ++i) camera[i] = parameters[i];
  return camera;
}

template <class Camera>
std::vector<double> numbersOf(const Camera& camera) {
  return {camera.data(), camera.data() + Camera::DOF};
}

template <class Camera>
ModelDefinition defineModel() {
  using Numbers = ModelDefinition::Numbers;
  static_assert(Camera::DOF <= Lens::most_parameters);
  ModelDefinition model;
  model.name = Camera::model_name;
  model.parameters.assign(Camera::component_names.begin(), Camera::component_names.end());
  if constexpr (requires { Camera::held_near_zero; })
    model.held_near_zero.assign(Camera::held_near_zero.begin(), Camera::held_near_zero.end());
  model.is_compared = true;
  if constexpr (requires { Camera::is_compared; }) model.is_compared = Camera::is_compared;
  model.start_lens = Camera::start_lens;
  model.starts = [](const Pinhole& pinhole) {
    std::vector<Numbers> starts;
    if constexpr (requires { Camera::startsFromPinhole(pinhole); }) {
      for (const Camera& start : Camera::startsFromPinhole(pinhole)) starts.push_back(numbersOf(start));
    } else {
      starts.push_back(numbersOf(Camera::fromPinhole(pinhole)));
    }
    return starts;
  };
  model.project = [](const double* parameters, const vec3& point) {
    return vec2(cameraOf<Camera>(parameters).project(point));
  };
  model.differentiate = [](const double* parameters, const Eigen::Vector3d& point,
                           Lens::Projection& projection) {
    const auto d = derivativesOf(cameraOf<Camera>(parameters), point);
    projection.pixel = d.pixel;
    projection.by_point = d.by_point;
    projection.by_parameters = d.by_parameters;
  };
  model.camera_matrix = [](const Numbers& parameters) {
    return Eigen::Matrix3d(cameraOf<Camera>(parameters.data()).cameraMatrix());
  };
  model.distortion = [](const Numbers& parameters) {
    const Eigen::VectorXd distortion = cameraOf<Camera>(parameters.data()).distortion();
    return Numbers(distortion.begin(), distortion.end());
  };
  model.for_opencv = [](const Numbers& parameters) {
    return cameraOf<Camera>(parameters.data()).forOpencv();
  };
  model.for_ros = [](const Numbers& parameters) { return cameraOf<Camera>(parameters.data()).forRos(); };
  model.for_kalibr = [](const Numbers& parameters) {
    return cameraOf<Camera>(parameters.data()).forKalibr();
  };
  return model;
}

}  // namespace slom::calibration

/// Defines the entry that the line of this name in models/list.inc refers to.
#define SLOM_CALIBRATION_DEFINE_MODEL(name, Camera)         \
  namespace slom::calibration::models {                     \
  const ModelDefinition& name() {                           \
    static const auto definition = defineModel<Camera<>>(); \
    return definition;                                      \
  }                                                         \
  }
