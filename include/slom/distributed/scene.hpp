/// Bundle adjustments in parts: each process reads one.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "slom/distributed/processes.hpp"
#include "slom/io/scene.hpp"

namespace slom::distributed {

/// The part of a scene that a process fits: its points with all their observations, and the cameras that see them. A
/// point is in the process that has most of its cameras. Cameras are divided such that those with common points stay
/// together (docs/scale_program.md).
struct ScenePart {
  io::Scene scene;           ///< observations name cameras and points by their places here
  std::vector<int> cameras;  ///< by place: number in the file, ascending
  std::vector<int> points;
  std::vector<std::int64_t> observations;  ///< by place: number in the file, ascending
  std::vector<char> own_cameras;           ///< by place: whether the camera belongs here
  int camera_count = 0, point_count = 0;   ///< numbers in the whole file
  std::int64_t observation_count = 0;
};

/// Reads a file of BAL, not compressed, or a container; each process reads an equal part. Throws in all processes what
/// io::readScene throws in one. Also throws [slom.io.bad-scene] for cameras and points without observations.
ScenePart readScene(const Processes& processes, const std::string& file);

}  // namespace slom::distributed
