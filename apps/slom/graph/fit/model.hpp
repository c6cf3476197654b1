// Measurements made from edges and sightings.
#pragma once

#include <vector>

#include <slom/estimator.hpp>
#include <slom/io/pose_graph_model.hpp>

#include "fitting/fit_options.hpp"
#include "graph/pose_graph.hpp"

namespace slom::app::graph {

using io::RotationError;

/// io::PoseGraphModel with the options of the command, compiled once.
struct GraphModel {
  FitOptions options;
  RotationError rotation_error = RotationError::vector;

  /// Sets algorithm, solver and threads.
  void prepare(Estimator& est) const { apply(options, est); }
  template <class Pose>
  void insertEdge(Estimator& est, const VarID<Pose>& a, const VarID<Pose>& b, const Edge<Pose>& edge) const;
  template <class Pose>
  void insertSighting(Estimator& est, const VarID<Pose>& a, const VarID<Point<Pose>>& p,
                      const Edge<Point<Pose>>& sighting) const;
  /// Inserts priors and bearings.
  template <class Pose>
  void insertOthers(Estimator& est, const PoseGraph<Pose>& graph, const std::vector<VarID<Pose>>& poses,
                    const std::vector<VarID<Point<Pose>>>& landmarks) const;
};

}  // namespace slom::app::graph
