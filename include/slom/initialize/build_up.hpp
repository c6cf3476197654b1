/// buildUp: start values from a map that grows pose by pose, with short fits in between.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "slom/estimator.hpp"
#include "slom/initialize/growing_map.hpp"

namespace slom::initialize {

/// How often and how long the growing map is fitted.
struct BuildUpOptions {
  double growth = 0.1;    ///< relative growth of the map since the last fit after which the next one follows
  int least_growth = 10;  ///< minimum growth between fits, in poses
  int iterations = 4;     ///< maximum number of iterations of each fit
};

namespace detail {

inline void fitShortly(Estimator& est, int iterations) {
  Options options;
  options.max_iterations = iterations;
  options.decrease_tolerance = 1e-3;
  options.deviation_tolerance = std::numeric_limits<double>::infinity();
  options.most_parameters = 0;
  (void)est.optimize(options);  // a start need not have converged
}

/// A whole graph in an estimator, to compare its values. If a model has a function insertOthers, as io::PoseGraphModel
/// has, it inserts measurements of other kinds.
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
    if constexpr (requires { model.insertOthers(est_, graph, poses_, landmarks_); })
      model.insertOthers(est_, graph, poses_, landmarks_);
  }
  /// Returns the RSS at the current values of the graph.
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

/// Adds one pose after another, in the order of growth() (spanning_tree.hpp). Fits the map for a few iterations
/// whenever it has grown by BuildUpOptions::growth and a loop may have closed since. Landmarks close loops, too. Takes
/// about 10 times as long as a fit of the whole map. Throws Unreached, and as inserting measurements does.
template <class Graph, class Model = RelationModel>
void buildUp(Graph& graph, const BuildUpOptions& options = {}, const Model& model = {}) {
  const std::vector<char> fixed = detail::fixedPoses(graph);
  const std::vector<TreeStep> tree = growth(fixed, detail::edgesOf(graph));
  Estimator est;
  GrowingMap<Graph, Model> map(est, graph, model);
  bool has_closed = false;
  for (std::size_t p = 0; p < fixed.size(); ++p) {
    if (fixed[p] != 0) has_closed = map.add(static_cast<int>(p), graph.poses[p].value, true) || has_closed;
  }
  double next = options.least_growth;
  for (std::size_t k = 0; k < tree.size(); ++k) {
    const TreeStep& step = tree[k];
    const detail::PoseOf<Graph> start = detail::follow(graph, step, *map.pose(step.parent));
    has_closed = map.add(step.child, start, false) || has_closed;
    const auto there = static_cast<double>(k + 1);
    if (!has_closed || there < next) continue;
    detail::fitShortly(est, options.iterations);
    next = std::max(there + options.least_growth, there * (1 + options.growth));
    has_closed = false;
  }
  if (has_closed) detail::fitShortly(est, options.iterations);
  map.writeTo(graph);
}

/// Returns the RSS of a graph at its values.
template <class Graph, class Model = RelationModel>
double rssOf(const Graph& graph, const Model& model = {}) {
  (void)detail::edgesOf(graph);  // checks them
  return detail::WholeMap<const Graph, Model>(graph, model).rss();
}

}  // namespace slom::initialize
