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
  /// Takes start values and fixed nodes from `graph`, and holds what `gauge` names.
  GraphFit(const PoseGraph<Pose>& graph, const Gauge& gauge, const GraphModel& model);

  Summary optimize(const Options& options) { return est_.optimize(options); }
  Estimator& estimator() { return est_; }
  /// Returns the poses in the order of the graph.
  const std::vector<VarID<Pose>>& poses() const { return variables_.poses; }
  /// Returns the landmarks in the order of the graph.
  const std::vector<VarID<Point<Pose>>>& landmarks() const { return variables_.landmarks; }
  /// Writes the values into the nodes of the graph.
  void writeTo(PoseGraph<Pose>& graph) const { variables_.writeTo(graph); }

 private:
  Estimator est_;
  io::PoseGraphVariables<Pose> variables_;
};

}  // namespace slom::app::graph
