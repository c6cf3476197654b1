#include "graph/output/sketch.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <numeric>

namespace slom::app::graph {

namespace {

/// Returns the poses by ascending id.
template <class Pose>
std::vector<int> orderOf(const PoseGraph<Pose>& graph) {
  std::vector<int> order(graph.poses.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return graph.poses[std::size_t(a)].id < graph.poses[std::size_t(b)].id; });
  return order;
}

}  // namespace

std::pair<Sketch::Place, Sketch::Place> Sketch::bounds() const {
  Place low = poses.front(), high = low;
  for (const auto* places : {&poses, &landmarks}) {
    for (const Place& place : *places) {
      for (std::size_t i = 0; i < 3; ++i) {
        low[i] = std::min(low[i], place[i]);
        high[i] = std::max(high[i], place[i]);
      }
    }
  }
  if (low[0] == high[0]) {  // gives the drawing a width
    const double half = low == high ? 1 : std::max(high[1] - low[1], high[2] - low[2]) / 8;
    low[0] -= half;
    high[0] += half;
  }
  return {low, high};
}

template <class Pose>
Sketch sketchOf(const PoseGraph<Pose>& graph, std::vector<int> order) {
  Sketch sketch;
  sketch.name = std::filesystem::path(graph.file).filename().string();
  sketch.is_flat = dim<Pose> == 2;
  if (order.empty()) order = orderOf(graph);
  std::vector<int> rank(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const auto& pose = graph.poses[std::size_t(order[i])];
    rank[std::size_t(order[i])] = int(i);
    sketch.poses.push_back(placeOf(pose.value.pos));
    if (pose.fixed) sketch.fixed.push_back(int(i));
  }
  for (const auto& edge : graph.edges) {
    const int a = rank[std::size_t(edge.from)], b = rank[std::size_t(edge.to)];
    (std::abs(a - b) == 1 ? sketch.path : sketch.closures).emplace_back(std::min(a, b), std::max(a, b));
  }
  std::sort(sketch.path.begin(), sketch.path.end());
  sketch.path.erase(std::unique(sketch.path.begin(), sketch.path.end()), sketch.path.end());
  for (const auto& landmark : graph.landmarks) sketch.landmarks.push_back(placeOf(landmark.value));
  return sketch;
}

template Sketch sketchOf(const PoseGraph<Pose2>&, std::vector<int>);
template Sketch sketchOf(const PoseGraph<Pose3>&, std::vector<int>);

}  // namespace slom::app::graph
