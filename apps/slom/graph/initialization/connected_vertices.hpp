// The vertices that measurements connect.
#pragma once

#include "disjoint_sets.hpp"
#include "graph/pose_graph.hpp"

namespace slom::app::graph {

/// Returns the sets of vertices that measurements connect. Landmarks count after poses.
template <class Pose>
DisjointSets connectedVertices(const PoseGraph<Pose>& graph) {
  const int poses = int(graph.poses.size());
  DisjointSets sets(graph.poses.size() + graph.landmarks.size());
  for (const auto& edge : graph.edges) sets.join(edge.from, edge.to);
  for (const auto& sighting : graph.sightings) sets.join(sighting.from, poses + sighting.to);
  for (const auto& bearing : graph.bearings) sets.join(bearing.from, poses + bearing.to);
  return sets;
}

}  // namespace slom::app::graph
