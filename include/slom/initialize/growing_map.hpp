/// A map that grows pose by pose, as a robot drives.
///
///     GrowingMap<io::PoseGraph<io::Pose2>, io::PoseGraphModel> map(est, graph);
///     for (int i = 0; i < poses; ++i) {
///       map.add(i);
///       est.update();
///     }
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "slom/estimator.hpp"
#include "slom/initialize/chordal.hpp"
#include "slom/initialize/relation_model.hpp"

namespace slom::initialize {

/// The part of a graph that is in an estimator. Variables of graphs whose nodes have an `id` are named by it: `pose 17`,
/// `landmark 3`.
template <class Graph, class Model = RelationModel>
class GrowingMap {
 public:
  using Pose = detail::PoseOf<Graph>;
  using Point = detail::PointOf<Graph>;

  /// Inserts nothing yet. The estimator and the graph must outlive this object. Throws [slom.no-such-node] where an edge or a sighting
  /// names a node that the graph does not have.
  GrowingMap(Estimator& est, const Graph& graph, const Model& model = {})
      : est_(est),
        graph_(graph),
        model_(model),
        poses_(graph.poses.size()),
        landmarks_(graph.landmarks.size()),
        rank_(graph.poses.size(), -1),
        edges_at_(graph.poses.size()),
        sightings_at_(graph.poses.size()) {
    (void)detail::edgesOf(graph);  // checks them
    model_.prepare(est_);
    for (std::size_t e = 0; e < graph.edges.size(); ++e) {
      edges_at_[index(graph.edges[e].from)].push_back(e);
      if (graph.edges[e].to != graph.edges[e].from) edges_at_[index(graph.edges[e].to)].push_back(e);
    }
    for (std::size_t s = 0; s < graph.sightings.size(); ++s)
      sightings_at_[index(graph.sightings[s].from)].push_back(s);
  }

  /// Inserts pose p, the edges between it and the poses that are there, what it sees, and landmarks that nothing saw before, where it
  /// sees them. Returns whether more measurements came than determine what is new: a loop may have closed.
  bool add(int p, const Pose& start, bool is_fixed) {
    const std::size_t i = index(p);
    poses_[i] = insertNode(start, !is_fixed, graph_.poses[i], "pose ");
    rank_[i] = static_cast<int>(order_.size());
    order_.push_back(p);
    is_fixed_.push_back(is_fixed ? 1 : 0);
    int edges = 0;
    for (const std::size_t e : edges_at_[i]) {
      const auto& edge = graph_.edges[e];
      const auto &a = poses_[index(edge.from)], &b = poses_[index(edge.to)];
      if (!a.isValid() || !b.isValid()) continue;
      model_.insertEdge(est_, a, b, edge);
      ++edges;
    }
    bool has_closed = edges > 1;
    for (const std::size_t s : sightings_at_[i]) {
      const auto& sighting = graph_.sightings[s];
      auto& l = landmarks_[index(sighting.to)];
      const auto& landmark = graph_.landmarks[index(sighting.to)];
      has_closed = has_closed || l.isValid() || landmark.fixed;
      if (!l.isValid()) {
        l = insertNode(landmark.fixed ? landmark.value : Point(*poses_[i] * sighting.measured),
                       !landmark.fixed, landmark, "landmark ");
      }
      model_.insertSighting(est_, poses_[i], l, sighting);
    }
    return has_closed;
  }
  /// The same at startOf(p), fixed as the graph says.
  bool add(int p) { return add(p, startOf(p), graph_.poses[index(p)].fixed); }

  /// Where the edge from the pose that came last puts pose p. The pose of the graph where it is fixed, or where no edge leads to it from
  /// poses that are there.
  Pose startOf(int p) const {
    const auto& node = graph_.poses[index(p)];
    Pose start = node.value;
    int newest = -1;
    for (const std::size_t e : edges_at_[index(p)]) {
      const auto& edge = graph_.edges[e];
      const bool is_forward = edge.to == p;
      const int other = is_forward ? edge.from : edge.to;
      if (node.fixed || rank_[index(other)] <= newest) continue;
      newest = rank_[index(other)];
      start = detail::follow(graph_, TreeStep{static_cast<int>(e), other, p, is_forward}, *pose(other));
    }
    return start;
  }

  /// Not valid before it was added; a landmark, before it was seen.
  const VarID<Pose>& pose(int p) const { return poses_[index(p)]; }
  /// The variable of landmark l of the graph, as pose() does of poses.
  const VarID<Point>& landmark(int l) const { return landmarks_[index(l)]; }
  /// The same map in another estimator, at the present values: the batch fit of what is there.
  GrowingMap copyTo(Estimator& est) const {
    GrowingMap copy(est, graph_, model_);
    for (std::size_t k = 0; k < order_.size(); ++k) copy.add(order_[k], *pose(order_[k]), is_fixed_[k] != 0);
    for (std::size_t l = 0; l < landmarks_.size(); ++l) {
      if (landmarks_[l].isValid()) est.reinitRV(copy.landmarks_[l], *landmarks_[l]);
    }
    return copy;
  }
  /// Writes the values of what is there into the nodes of such a graph.
  void writeTo(Graph& graph) const {
    for (std::size_t p = 0; p < poses_.size(); ++p) {
      if (poses_[p].isValid()) graph.poses[p].value = *poses_[p];
    }
    for (std::size_t l = 0; l < landmarks_.size(); ++l) {
      if (landmarks_[l].isValid()) graph.landmarks[l].value = *landmarks_[l];
    }
  }

 private:
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }

  template <class Value>
  VarID<Value> insertNode(const Value& value, bool is_optimized, const auto& node, const char* kind) {
    if constexpr (requires { node.id; }) {
      return est_.insertRV(value, is_optimized, kind + std::to_string(node.id));
    } else {
      return est_.insertRV(value, is_optimized);
    }
  }

  Estimator& est_;
  const Graph& graph_;
  Model model_;
  std::vector<VarID<Pose>> poses_;
  std::vector<VarID<Point>> landmarks_;
  std::vector<int> rank_;   // place of each pose in order_; -1: it is not there
  std::vector<int> order_;  // poses in the order of insertion
  std::vector<char> is_fixed_;
  std::vector<std::vector<std::size_t>> edges_at_, sightings_at_;
};

}  // namespace slom::initialize
