#include "graph/fit/fit.hpp"

namespace slom::app::graph {

template <class Pose>
GraphFit<Pose>::GraphFit(const PoseGraph<Pose>& graph, const Gauge& gauge, const GraphModel& model) {
  model.prepare(est_);
  variables_ = io::insert(est_, graph, model);
  for (const HeldRotation& held : gauge.rotations)
    est_.fix(variables_.poses[std::size_t(held.pose)], held.path);
}

template class GraphFit<Pose2>;
template class GraphFit<Pose3>;

}  // namespace slom::app::graph
