// Values of a scene in checkpoints, by the numbers of cameras and points in the file.
#pragma once

#include <vector>

#include <slom/io/checkpoint.hpp>
#include <slom/io/scene_model.hpp>

#include "bundle/scene.hpp"
#include "bundle/scene_numbers.hpp"

namespace slom::app::bundle {

/// Describes the scene. `scene` and `numbers` must outlive the result.
io::Checkpoint::Problem problemOf(const Scene& scene, const SceneNumbers& numbers);

/// Gives cameras and points the values of an earlier run.
void takeValues(const io::Checkpoint& checkpoint, const SceneNumbers& numbers, Scene& scene);

/// Returns the values of all points, and of the cameras for which `is_written`, by place; empty: all.
io::Checkpoint::Values valuesOf(const std::vector<VarID<Camera>>& cameras,
                                const std::vector<VarID<mtk::vect<3>>>& points, const SceneNumbers& numbers,
                                const std::vector<char>& is_written = {});

}  // namespace slom::app::bundle
