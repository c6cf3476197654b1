/// Start values from composing one edge after another.
#pragma once

#include <cstddef>
#include <vector>

#include "mtk/error.hpp"

namespace slom::initialize {

/// Error for a pose that no edge leads to.
class Unreached : public mtk::Error {
 public:
  /// Creates the error [slom.unreached-pose] with the name of the pose.
  explicit Unreached(int pose);
  /// Returns the index of the pose.
  int pose() const { return pose_; }

 private:
  int pose_;
};

/// The two poses of an edge, or the pose and the landmark of a sighting.
struct Ends {
  int from = 0, to = 0;
};

/// An edge that is followed from a known pose to an unknown one.
struct TreeStep {
  int edge = 0;
  int parent = 0, child = 0;  ///< poses
  bool is_forward = true;     ///< the edge begins at parent
};

/// Returns a breadth-first tree from all fixed poses (from pose 0 if there is none), so that each pose is reached by
/// the fewest edges. Throws Unreached.
std::vector<TreeStep> spanningTree(const std::vector<char>& is_fixed, const std::vector<Ends>& edges);
/// Returns the steps along edges between i and i + 1 only. Throws Unreached.
std::vector<TreeStep> odometryChain(const std::vector<char>& is_fixed, const std::vector<Ends>& edges);
/// Returns the order in which a map grows. The next pose is always the one of smallest index that an edge connects with
/// a present pose. The edge is the one from the nearest index. Throws Unreached.
std::vector<TreeStep> growth(const std::vector<char>& is_fixed, const std::vector<Ends>& edges);

namespace detail {

/// Throws [slom.no-such-node] if an end is not below the number of nodes.
void requireNodes(const std::vector<Ends>& ends, std::size_t sources, std::size_t targets, const char* kind);

template <class Edges>
std::vector<Ends> endsOf(const Edges& edges) {
  std::vector<Ends> ends;
  ends.reserve(edges.size());
  for (const auto& edge : edges) ends.push_back({edge.from, edge.to});
  return ends;
}

/// Returns the ends of all edges after checking them.
template <class Graph>
std::vector<Ends> edgesOf(const Graph& graph) {
  std::vector<Ends> edges = endsOf(graph.edges);
  requireNodes(edges, graph.poses.size(), graph.poses.size(), "edge");
  requireNodes(endsOf(graph.sightings), graph.poses.size(), graph.landmarks.size(), "sighting");
  return edges;
}

/// Returns which poses keep their value: the fixed ones, or the first one if none is fixed.
template <class Graph>
std::vector<char> fixedPoses(const Graph& graph) {
  std::vector<char> fixed;
  fixed.reserve(graph.poses.size());
  bool has_fixed = false;
  for (const auto& pose : graph.poses) {
    fixed.push_back(pose.fixed ? 1 : 0);
    has_fixed = has_fixed || pose.fixed;
  }
  if (!has_fixed && !fixed.empty()) fixed.front() = 1;
  return fixed;
}

/// Returns the pose that a step leads to from its parent: parent * edge, or parent * edge^-1.
template <class Graph, class Pose>
Pose follow(const Graph& graph, const TreeStep& step, const Pose& parent) {
  const auto& z = graph.edges[static_cast<std::size_t>(step.edge)].measured;
  return step.is_forward ? parent * z : parent * z.inverse();
}

template <class Graph>
void compose(Graph& graph, const std::vector<TreeStep>& tree) {
  for (const TreeStep& step : tree) {
    graph.poses[static_cast<std::size_t>(step.child)].value =
        follow(graph, step, graph.poses[static_cast<std::size_t>(step.parent)].value);
  }
}

}  // namespace detail

/// Sets each landmark to the place where the first pose that observes it puts it.
template <class Graph>
void placeLandmarks(Graph& graph) {
  std::vector<char> is_placed(graph.landmarks.size(), 0);
  for (const auto& sighting : graph.sightings) {
    const auto l = static_cast<std::size_t>(sighting.to);
    auto& landmark = graph.landmarks[l];
    if (landmark.fixed || is_placed[l]++ != 0) continue;
    landmark.value = graph.poses[static_cast<std::size_t>(sighting.from)].value * sighting.measured;
  }
}

/// Sets all poses along the fewest edges from the fixed ones, then the landmarks. Throws Unreached.
template <class Graph>
void alongSpanningTree(Graph& graph) {
  detail::compose(graph, spanningTree(detail::fixedPoses(graph), detail::edgesOf(graph)));
  placeLandmarks(graph);
}

/// Sets all poses along the edges between pose i and pose i + 1, then the landmarks. Throws Unreached.
template <class Graph>
void alongOdometry(Graph& graph) {
  detail::compose(graph, odometryChain(detail::fixedPoses(graph), detail::edgesOf(graph)));
  placeLandmarks(graph);
}

}  // namespace slom::initialize
