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

template <class Pose>
void GraphModel::insertOthers(Estimator& est, const PoseGraph<Pose>& graph,
                              const std::vector<VarID<Pose>>& poses,
                              const std::vector<VarID<Point<Pose>>>& landmarks) const {
  io::PoseGraphModel{options.loss, rotation_error}.insertOthers(est, graph, poses, landmarks);
}

template void GraphModel::insertOthers(Estimator&, const PoseGraph<Pose2>&, const std::vector<VarID<Pose2>>&,
                                       const std::vector<VarID<Point<Pose2>>>&) const;
template void GraphModel::insertOthers(Estimator&, const PoseGraph<Pose3>&, const std::vector<VarID<Pose3>>&,
                                       const std::vector<VarID<Point<Pose3>>>&) const;
template void GraphModel::insertEdge(Estimator&, const VarID<Pose2>&, const VarID<Pose2>&,
                                     const Edge<Pose2>&) const;
template void GraphModel::insertEdge(Estimator&, const VarID<Pose3>&, const VarID<Pose3>&,
                                     const Edge<Pose3>&) const;
template void GraphModel::insertSighting(Estimator&, const VarID<Pose2>&, const VarID<Point<Pose2>>&,
                                         const Edge<Point<Pose2>>&) const;
template void GraphModel::insertSighting(Estimator&, const VarID<Pose3>&, const VarID<Point<Pose3>>&,
                                         const Edge<Point<Pose3>>&) const;

}  // namespace slom::app::graph
