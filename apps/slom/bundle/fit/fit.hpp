// The fit of a scene.
#pragma once

#include <vector>

#include <slom/estimator.hpp>
#include <slom/io/scene_model.hpp>

#include "bundle/scene.hpp"
#include "bundle/settings.hpp"

namespace slom::app::bundle {

/// Sets algorithm, solver and threads for scenes.
void prepare(const FitOptions& options, Estimator& est);

/// Cameras and points as variables, named by their numbers (`camera 3`, `point 17`), observations as
/// measurements:
///   residual  CameraProjection of the point by the camera - observed pixel, with a standard deviation of 1 px
class BundleFit {
 public:
  /// Takes start values and observations from `scene`.
  BundleFit(const Scene& scene, const FitOptions& options);

  Summary optimize(const Options& options) { return est_.optimize(options); }
  Estimator& estimator() { return est_; }
  /// Returns the cameras, and points() the points, in the order of the scene.
  const std::vector<VarID<Camera>>& cameras() const { return variables_.cameras; }
  const std::vector<VarID<mtk::vect<3>>>& points() const { return variables_.points; }
  /// Writes the values into the cameras and points of the scene.
  void writeTo(Scene& scene) const { variables_.writeTo(scene); }

 private:
  Estimator est_;
  io::SceneVariables variables_;
};

}  // namespace slom::app::bundle
