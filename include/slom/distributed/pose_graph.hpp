/// Pose graphs in parts: each process reads one.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "slom/distributed/pieces.hpp"
#include "slom/distributed/processes.hpp"
#include "slom/io/pose_graph.hpp"

namespace slom::distributed {

/// The part of a pose graph that a process fits: its own vertices, the measurements that lead from them, and the other
/// vertices that these measurements lead to. Vertices are divided by their ids into ranges of equal numbers, because
/// neighbours on a path usually have similar ids.
template <class Pose>
struct GraphPart {
  io::PoseGraph<Pose> graph;
  std::vector<char> own_poses, own_landmarks;        ///< by node: whether it is one of the own vertices
  std::vector<char> shared_poses, shared_landmarks;  ///< by node: whether other processes have it, too
  std::uint64_t first_pose = 0;  ///< id of the first pose of the whole file, in the order of the lines
  bool has_fix_lines = false, has_priors = false;  ///< of the whole file
  std::int64_t poses = 0, landmarks = 0, edges = 0, sightings = 0, bearings = 0,
               priors = 0;      ///< numbers in the whole file
  std::int64_t line_count = 0;  ///< of the whole file
};

using AnyGraphPart = std::variant<GraphPart<io::Pose2>, GraphPart<io::Pose3>>;

/// Reads a file of g2o or TORO, or a container; each process reads an equal part. Throws in all processes what
/// io::readPoseGraph throws in one. Also throws [slom.io.no-vertices] for a file without vertices.
AnyGraphPart readPoseGraph(const Processes& processes, const std::string& file);

/// Gives each vertex the value of the process that has fitted it. `is_fitted_here`: by node, of poses and landmarks.
template <class Pose>
void takeFittedValues(const Processes& processes, const std::vector<char>& is_pose_fitted_here,
                      const std::vector<char>& is_landmark_fitted_here, GraphPart<Pose>& part);

/// Hands out the text of io::toG2o for the whole graph, in the order of the file's lines. All processes call it.
template <class Pose>
void gatherG2o(const Processes& processes, const GraphPart<Pose>& part, const TextSink& f);

}  // namespace slom::distributed
