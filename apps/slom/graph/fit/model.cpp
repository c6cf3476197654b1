#include "graph/fit/model.hpp"

namespace slom::app::graph {

template <class Pose>
void GraphModel::insertEdge(Estimator& est, const VarID<Pose>& a, const VarID<Pose>& b,
                            const Edge<Pose>& edge) const {
  io::PoseGraphModel{options.loss, rotation_error}.insertEdge(est, a, b, edge);
}

template <class Pose>
void GraphModel::insertSighting(Estimator& est, const VarID<Pose>& a, const VarID<Point<Pose>>& p,
                                const Edge<Point<Pose>>& sighting) const {
  io::PoseGraphModel{options.loss, rotation_error}.insertSighting(est, a, p, sighting);
}

template void GraphModel::insertEdge(Estimator&, const VarID<Pose2>&, const VarID<Pose2>&,
                                     const Edge<Pose2>&) const;
template void GraphModel::insertEdge(Estimator&, const VarID<Pose3>&, const VarID<Pose3>&,
                                     const Edge<Pose3>&) const;
template void GraphModel::insertSighting(Estimator&, const VarID<Pose2>&, const VarID<Point<Pose2>>&,
                                         const Edge<Point<Pose2>>&) const;
template void GraphModel::insertSighting(Estimator&, const VarID<Pose3>&, const VarID<Point<Pose3>>&,
                                         const Edge<Point<Pose3>>&) const;

}  // namespace slom::app::graph
