// The fit of a pose graph.
#pragma once

#include <slom/estimator.hpp>

#include "graph/pose_graph.hpp"
#include "graph/settings.hpp"

namespace slom::app::graph {

/// Poses and landmarks as variables, named by their ids (`pose 17`), edges and sightings as measurements.
///   residual of an edge       z^-1 (a^-1 b): its translation, then its rotation as Settings::rotation_error
///   says residual of a sighting    a^-1 p - z whitened by W with W^T W = information, so that the RSS is the
///   sum of e^T information e
template <class Pose>
class GraphFit {
 public:
  /// Takes start values and what is held from `graph`.
  GraphFit(const PoseGraph<Pose>& graph, const Settings& settings);

  Summary optimize(const Options& options) { return est_.optimize(options); }
  Estimator& estimator() { return est_; }
  /// In the order of the graph's.
  const std::vector<VarID<Pose>>& poses() const { return poses_; }
  /// Writes the values into the nodes of the graph.
  void writeTo(PoseGraph<Pose>& graph) const;

 private:
  void insertEdge(const Edge<Pose>& edge, const Settings& settings);
  void insertSighting(const Edge<Point<Pose>>& sighting, const Loss& loss);

  Estimator est_;
  std::vector<VarID<Pose>> poses_;
  std::vector<VarID<Point<Pose>>> landmarks_;
};

}  // namespace slom::app::graph
