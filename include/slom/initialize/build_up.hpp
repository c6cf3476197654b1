/// A map that grows pose by pose, with short fits on the way.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "slom/estimator.hpp"
#include "slom/initialize/chordal.hpp"
#include "slom/measurements/landmark.hpp"
#include "slom/measurements/relative_pose.hpp"

namespace slom::initialize {

/// How a graph becomes measurements of an estimator: edges as slom::RelativePose, sightings as
/// slom::Landmark; of pose types without `orient` and `pos` as a^-1 b [-] z and a^-1 l - z. Functions of this
/// folder take any class with these members.
struct RelationModel {
  Loss loss;

  void prepare(Estimator&) const {}
  template <class Pose>
  void insertEdge(Estimator& est, const VarID<Pose>& a, const VarID<Pose>& b, const auto& edge) const {
    if constexpr (requires { edge.measured.orient, edge.measured.pos; }) {
      est.insertMeasurement(RelativePose(), a, b, measured(edge.measured), InvCovariance(edge.information),
                            loss, named("edge"));
    } else {
      est.insertMeasurement(RelativePoseInFrameOfA(), a, b, measured(edge.measured),
                            InvCovariance(edge.information), loss, named("edge"));
    }
  }
  template <class Pose, class Point>
  void insertSighting(Estimator& est, const VarID<Pose>& a, const VarID<Point>& l,
                      const auto& sighting) const {
    if constexpr (requires { a->orient, a->pos; }) {
      est.insertMeasurement(Landmark(), a, l, measured(sighting.measured),
                            InvCovariance(sighting.information), loss, named("sighting"));
    } else {
      est.insertMeasurement(
          [](const Pose& pose, const Point& point) { return Point(pose.inverse() * point); }, a, l,
          measured(sighting.measured), InvCovariance(sighting.information), loss, named("sighting"));
    }
  }
};

struct BuildUpOptions {
  double growth = 0.1;    ///< a fit follows when the map has grown by this part since the last one
  int least_growth = 10;  ///< poses
  int iterations = 4;     ///< of each fit, at most
};

namespace detail {

/// The part of a graph that is in an estimator.
template <class Graph, class Model>
class GrowingMap {
 public:
  GrowingMap(Graph& graph, const Model& model)
      : graph_(graph),
        model_(model),
        poses_(graph.poses.size()),
        landmarks_(graph.landmarks.size()),
        edges_at_(poses_.size()),
        sightings_at_(poses_.size()) {
    model.prepare(est_);
    for (std::size_t e = 0; e < graph.edges.size(); ++e) {
      edges_at_[index(graph.edges[e].from)].push_back(e);
      edges_at_[index(graph.edges[e].to)].push_back(e);
    }
    for (std::size_t s = 0; s < graph.sightings.size(); ++s)
      sightings_at_[index(graph.sightings[s].from)].push_back(s);
  }

  /// Inserts pose p with the value that it has, landmarks that it sees first where it sees them, and all
  /// measurements between what is there. Returns whether more measurements came than determine what is new.
  bool add(int p, bool is_held) {
    const std::size_t i = index(p);
    poses_[i] = est_.insertRV(graph_.poses[i].value, !is_held);
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
      has_closed = has_closed || l.isValid() || landmark.held;
      if (!l.isValid())
        l = est_.insertRV(landmark.held ? landmark.value : PointOf<Graph>(*poses_[i] * sighting.measured),
                          !landmark.held);
      model_.insertSighting(est_, poses_[i], l, sighting);
    }
    return has_closed;
  }
  const auto& pose(int p) const { return *poses_[index(p)]; }

  void fit(int iterations) {
    Options options;
    options.max_iterations = iterations;
    options.decrease_tolerance = 1e-3;
    options.deviation_tolerance = std::numeric_limits<double>::infinity();
    options.most_parameters = 0;
    (void)est_.optimize(options);  // a start need not have converged
  }
  void writeBack() {
    for (std::size_t p = 0; p < poses_.size(); ++p) graph_.poses[p].value = *poses_[p];
    for (std::size_t l = 0; l < landmarks_.size(); ++l) {
      if (landmarks_[l].isValid()) graph_.landmarks[l].value = *landmarks_[l];
    }
  }

 private:
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }

  Graph& graph_;
  const Model& model_;
  Estimator est_;
  std::vector<VarID<PoseOf<Graph>>> poses_;
  std::vector<VarID<PointOf<Graph>>> landmarks_;
  std::vector<std::vector<std::size_t>> edges_at_, sightings_at_;
};

/// A whole graph in an estimator, to compare values of it.
template <class Graph, class Model>
class WholeMap {
 public:
  WholeMap(const Graph& graph, const Model& model) : graph_(graph) {
    model.prepare(est_);
    for (const auto& pose : graph.poses) poses_.push_back(est_.insertRV(pose.value));
    for (const auto& landmark : graph.landmarks) landmarks_.push_back(est_.insertRV(landmark.value));
    const auto pose = [&](int p) { return poses_[static_cast<std::size_t>(p)]; };
    for (const auto& edge : graph.edges) model.insertEdge(est_, pose(edge.from), pose(edge.to), edge);
    for (const auto& sighting : graph.sightings)
      model.insertSighting(est_, pose(sighting.from), landmarks_[static_cast<std::size_t>(sighting.to)],
                           sighting);
  }
  /// At the values that the graph has now.
  double rss() {
    for (std::size_t p = 0; p < poses_.size(); ++p) est_.reinitRV(poses_[p], graph_.poses[p].value);
    for (std::size_t l = 0; l < landmarks_.size(); ++l)
      est_.reinitRV(landmarks_[l], graph_.landmarks[l].value);
    return est_.getRSS();
  }

 private:
  const Graph& graph_;
  Estimator est_;
  std::vector<VarID<PoseOf<Graph>>> poses_;
  std::vector<VarID<PointOf<Graph>>> landmarks_;
};

}  // namespace detail

/// Adds one pose after the other, as spanning_tree.hpp's growth() orders them, and fits the map for a few
/// iterations whenever it has grown by a part of itself and has been seen again since. Landmarks close loops
/// too. Takes some ten times as long as a fit of all. Throws Unreached, and what inserting measurements
/// throws.
template <class Graph, class Model = RelationModel>
void buildUp(Graph& graph, const BuildUpOptions& options = {}, const Model& model = {}) {
  const std::vector<char> held = detail::heldPoses(graph);
  const std::vector<TreeStep> tree = growth(held, detail::edgesOf(graph));
  detail::GrowingMap<Graph, Model> map(graph, model);
  bool has_closed = false;
  for (std::size_t p = 0; p < held.size(); ++p) {
    if (held[p] != 0) has_closed = map.add(static_cast<int>(p), true) || has_closed;
  }
  double next = options.least_growth;
  for (std::size_t k = 0; k < tree.size(); ++k) {
    const TreeStep& step = tree[k];
    graph.poses[static_cast<std::size_t>(step.child)].value =
        detail::follow(graph, step, map.pose(step.parent));
    has_closed = map.add(step.child, false) || has_closed;
    const auto there = static_cast<double>(k + 1);
    if (!has_closed || there < next) continue;
    map.fit(options.iterations);
    next = std::max(there + options.least_growth, there * (1 + options.growth));
    has_closed = false;
  }
  if (has_closed) map.fit(options.iterations);
  map.writeBack();
}

/// The RSS of a graph at its values.
template <class Graph, class Model = RelationModel>
double rssOf(const Graph& graph, const Model& model = {}) {
  (void)detail::edgesOf(graph);  // checks them
  return detail::WholeMap<const Graph, Model>(graph, model).rss();
}

}  // namespace slom::initialize
