// Values of a graph in checkpoints, by the ids of its vertices.
#pragma once

#include <cstdint>
#include <string_view>
#include <unordered_map>

#include <fmt/format.h>

#include <slom/io/checkpoint.hpp>
#include <slom/io/data_hash.hpp>

#include "fitting/checkpoints.hpp"
#include "graph/fit/fit.hpp"
#include "graph/pose_graph.hpp"

namespace slom::app::graph {

/// Describes a graph. `graph` has the part of this process and must outlive the result. The counts are of the whole
/// graph.
template <class Pose>
io::Checkpoint::Problem problemOf(const PoseGraph<Pose>& graph, std::int64_t poses, std::int64_t landmarks,
                                  std::int64_t edges) {
  return {fmt::format("graph of {} poses, {} landmarks, {} edges", poses, landmarks, edges),
          [&graph] { return io::dataHash(graph); }};
}

/// Gives vertices the values of an earlier run.
template <class Pose>
void takeValues(const io::Checkpoint& checkpoint, PoseGraph<Pose>& graph) {
  std::unordered_map<std::uint64_t, Pose*> poses;
  std::unordered_map<std::uint64_t, Point<Pose>*> landmarks;
  for (auto& pose : graph.poses) poses.emplace(pose.id, &pose.value);
  for (auto& landmark : graph.landmarks) landmarks.emplace(landmark.id, &landmark.value);
  checkpoint.read([&](std::uint64_t name, std::string_view bytes) {
    if (const auto pose = poses.find(name); pose != poses.end()) takeValue(bytes, *pose->second);
    if (const auto landmark = landmarks.find(name); landmark != landmarks.end())
      takeValue(bytes, *landmark->second);
  });
}

/// Returns the values of the vertices for which `is_written(variable)`.
template <class Pose, class F>
io::Checkpoint::Values valuesOf(const PoseGraph<Pose>& graph, const GraphFit<Pose>& fit,
                                const F& is_written) {
  io::Checkpoint::Values values;
  const auto add = [&](const auto& nodes, const auto& variables) {
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (is_written(variables[i])) values.add(nodes[i].id, *variables[i]);
    }
  };
  add(graph.poses, fit.poses());
  add(graph.landmarks, fit.landmarks());
  return values;
}

}  // namespace slom::app::graph
