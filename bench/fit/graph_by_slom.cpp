// Pose graphs by SLoM, as the command `slom graph` fits them.
#include "graph/fit/fit.hpp"

#include "fit/run.hpp"

namespace slom::bench {

template <class Pose>
Run fitBySlom(const app::graph::PoseGraph<Pose>& graph, const Limits& limits) {
  app::graph::Settings settings;
  settings.fit.threads = limits.threads;
  app::graph::GraphFit<Pose> fit(graph, settings);
  Options options;
  options.max_iterations = limits.max_iterations;
  return runOf(fit.optimize(options));
}

template Run fitBySlom(const app::graph::PoseGraph<app::graph::Pose2>&, const Limits&);
template Run fitBySlom(const app::graph::PoseGraph<app::graph::Pose3>&, const Limits&);

}  // namespace slom::bench
