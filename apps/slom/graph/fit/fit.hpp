// The fit of a pose graph.
#pragma once

#include <vector>

#include <slom/estimator.hpp>

#include "graph/fit/held.hpp"
#include "graph/fit/model.hpp"
#include "graph/pose_graph.hpp"

namespace slom::app::graph {

/// Poses and landmarks as variables, named by their ids (`pose 17`), edges and sightings as measurements.
template <class Pose>
class GraphFit {
 public:
  /// Takes start values and what is fixed from `graph`, and holds what `gauge` says.
  GraphFit(const PoseGraph<Pose>& graph, const Gauge& gauge, const GraphModel& model);

  Summary optimize(const Options& options) { return est_.optimize(options); }
  Estimator& estimator() { return est_; }
  /// In the order of the graph's.
  const std::vector<VarID<Pose>>& poses() const { return variables_.poses; }
  /// Writes the values into the nodes of the graph.
  void writeTo(PoseGraph<Pose>& graph) const { variables_.writeTo(graph); }

 private:
  Estimator est_;
  io::PoseGraphVariables<Pose> variables_;
};

}  // namespace slom::app::graph
