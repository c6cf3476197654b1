#include "graph/fit/fit.hpp"

namespace slom::app::graph {

namespace {

template <class Value>
std::vector<VarID<Value>> insertNodes(Estimator& est, const std::vector<Node<Value>>& nodes,
                                      const char* kind) {
  std::vector<VarID<Value>> ids;
  ids.reserve(nodes.size());
  for (const Node<Value>& node : nodes)
    ids.push_back(est.insertRV(node.value, !node.held, kind + std::to_string(node.id)));
  return ids;
}

}  // namespace

template <class Pose>
GraphFit<Pose>::GraphFit(const PoseGraph<Pose>& graph, const GraphModel& model)
    : poses_(insertNodes(est_, graph.poses, "pose ")),
      landmarks_(insertNodes(est_, graph.landmarks, "landmark ")) {
  model.prepare(est_);
  for (const auto& edge : graph.edges)
    model.insertEdge(est_, poses_[std::size_t(edge.from)], poses_[std::size_t(edge.to)], edge);
  for (const auto& sighting : graph.sightings) {
    model.insertSighting(est_, poses_[std::size_t(sighting.from)], landmarks_[std::size_t(sighting.to)],
                         sighting);
  }
}

template <class Pose>
void GraphFit<Pose>::writeTo(PoseGraph<Pose>& graph) const {
  for (std::size_t i = 0; i < poses_.size(); ++i) graph.poses[i].value = *poses_[i];
  for (std::size_t i = 0; i < landmarks_.size(); ++i) graph.landmarks[i].value = *landmarks_[i];
}

template class GraphFit<Pose2>;
template class GraphFit<Pose3>;

}  // namespace slom::app::graph
