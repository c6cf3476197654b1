// How edges and sightings become measurements.
#pragma once

#include <slom/estimator.hpp>

#include "fitting/fit_options.hpp"
#include "graph/pose_graph.hpp"

namespace slom::app::graph {

/// What the three rotational components of an edge's error in space are.
enum class RotationError {
  vector,     ///< the rotation vector, axis times angle [rad]
  quaternion  ///< the vector part of the unit quaternion with w >= 0, as in g2o
};

///   residual of an edge      z^-1 (a^-1 b): its translation, then its rotation as RotationError says
///   residual of a sighting   a^-1 p - z
/// whitened by W with W^T W = information, so that the RSS is the sum of e^T information e.
struct GraphModel {
  FitOptions options;
  RotationError rotation_error = RotationError::vector;

  /// Algorithm, solver and threads.
  void prepare(Estimator& est) const { apply(options, est); }
  template <class Pose>
  void insertEdge(Estimator& est, const VarID<Pose>& a, const VarID<Pose>& b, const Edge<Pose>& edge) const;
  template <class Pose>
  void insertSighting(Estimator& est, const VarID<Pose>& a, const VarID<Point<Pose>>& p,
                      const Edge<Point<Pose>>& sighting) const;
};

}  // namespace slom::app::graph
