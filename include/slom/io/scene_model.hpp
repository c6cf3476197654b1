/// Conversion of a bundle adjustment of a file to variables and measurements of an estimator.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "slom/estimator.hpp"
#include "slom/io/scene.hpp"

namespace slom::io {

/// The variables of a scene, in the order of its cameras and points.
struct SceneVariables {
  std::vector<VarID<Camera>> cameras;
  std::vector<VarID<mtk::vect<3>>> points;

  /// Writes the values of the variables into the cameras and points of the scene.
  void writeTo(Scene& scene) const {
    for (std::size_t i = 0; i < cameras.size(); ++i) scene.cameras[i] = *cameras[i];
    for (std::size_t i = 0; i < points.size(); ++i) scene.points[i] = *points[i];
  }
};

namespace detail {

template <class T>
std::vector<VarID<T>> insertAll(Estimator& est, const std::vector<T>& values, const char* kind) {
  std::vector<VarID<T>> ids;
  ids.reserve(values.size());
  for (const T& value : values) ids.push_back(est.insertRV(value, kind + std::to_string(ids.size())));
  return ids;
}

}  // namespace detail

/// Inserts the observations of a scene as measurements, see insert().
inline void insertObservations(Estimator& est, const Scene& scene, const SceneVariables& ids,
                               const Loss& loss = {}) {
  for (const Observation& observation : scene.observations) {
    est.insertMeasurement(CameraProjection(), ids.cameras[static_cast<std::size_t>(observation.camera)],
                          ids.points[static_cast<std::size_t>(observation.point)],
                          measured(observation.pixel), loss, named("observation"));
  }
}

/// Inserts all cameras and points, named by their numbers (`camera 3`, `point 17`), and all observations as
/// measurements named `observation`.
///   residual  CameraProjection of the point by the camera - observed pixel, with a standard deviation of 1 px
/// Nothing is fixed, although position, rotation and scale of a scene are unknown. Levenberg-Marquardt works without
/// fixing. For other algorithms, fix a camera and a point.
inline SceneVariables insert(Estimator& est, const Scene& scene, const Loss& loss = {}) {
  SceneVariables ids{detail::insertAll(est, scene.cameras, "camera "),
                     detail::insertAll(est, scene.points, "point ")};
  insertObservations(est, scene, ids, loss);
  return ids;
}

}  // namespace slom::io
