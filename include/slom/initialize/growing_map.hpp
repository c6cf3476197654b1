/// GrowingMap: a map that grows pose by pose, as when a robot drives.
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

/// The part of a graph that is in an estimator. If the nodes of the graph have an `id`, variables are named by it:
/// `pose 17`, `landmark 3`.
template <class Graph, class Model = RelationModel>
class GrowingMap {
 public:
  using Pose = detail::PoseOf<Graph>;
  using Point = detail::PointOf<Graph>;

  /// Prepares the map without inserting anything. The estimator and the graph must outlive this object. Throws
  /// [slom.no-such-node] if an edge or a sighting names a node that the graph does not have.
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

  /// Inserts pose p, the edges between it and the present poses, and its sightings. New landmarks are inserted at the
  /// place where the pose sees them. Returns whether there are more measurements than the new variables need: a loop
  /// may then have closed.
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
  /// Inserts pose p at startOf(p), fixed if the graph says so.
  bool add(int p) { return add(p, startOf(p), graph_.poses[index(p)].fixed); }

  /// Returns the start value of pose p: where the edge from the latest pose puts it. If pose p is fixed, or if no edge
  /// leads to it from present poses, returns the value in the graph.
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

  /// Returns the variable of pose p. The handle is not valid before the pose is added.
  const VarID<Pose>& pose(int p) const { return poses_[index(p)]; }
  /// Returns the variable of landmark l. The handle is not valid before the landmark is seen.
  const VarID<Point>& landmark(int l) const { return landmarks_[index(l)]; }
  /// Returns the present map in another estimator, at the present values, for a batch fit.
  GrowingMap copyTo(Estimator& est) const {
    GrowingMap copy(est, graph_, model_);
    for (std::size_t k = 0; k < order_.size(); ++k) copy.add(order_[k], *pose(order_[k]), is_fixed_[k] != 0);
    for (std::size_t l = 0; l < landmarks_.size(); ++l) {
      if (landmarks_[l].isValid()) est.reinitRV(copy.landmarks_[l], *landmarks_[l]);
    }
    return copy;
  }
  /// Writes the present values into the nodes of such a graph.
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
  std::vector<int> rank_;   // place of each pose in order_; -1: not added
  std::vector<int> order_;  // poses in the order of insertion
  std::vector<char> is_fixed_;
  std::vector<std::vector<std::size_t>> edges_at_, sightings_at_;
};

}  // namespace slom::initialize
