#include "graph/fit/fit.hpp"

namespace slom::app::graph {

template <class Pose>
GraphFit<Pose>::GraphFit(const PoseGraph<Pose>& graph, const GraphModel& model) {
  model.prepare(est_);
  variables_ = io::insert(est_, graph, model);
}

template class GraphFit<Pose2>;
template class GraphFit<Pose3>;

}  // namespace slom::app::graph
