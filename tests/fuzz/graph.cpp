// Pose graphs of g2o and TORO. A graph that is read, written and read again stays the same.
#include <variant>

#include <slom/io/g2o.hpp>

#include "fuzz/target.hpp"

SLOM_FUZZ_TARGET(graph) {
  using namespace slom::io;
  AnyPoseGraph graph;
  const MemoryFile file(input);
  if (!accepted([&] { graph = readPoseGraph(file.name()); })) return;
  std::visit(
      [](const auto& first) {
        using Graph = std::decay_t<decltype(first)>;
        for (const auto& pose : first.poses) require(pose.value.pos.allFinite(), "a pose is not finite");
        for (const auto& edge : first.edges)
          require(edge.information.allFinite(), "an information matrix is not finite");
        const MemoryFile again(toG2o(first));
        const auto second = std::get<Graph>(readPoseGraph(again.name()));
        require(second.poses.size() == first.poses.size() &&
                    second.landmarks.size() == first.landmarks.size() &&
                    second.edges.size() == first.edges.size() &&
                    second.sightings.size() == first.sightings.size(),
                "the graph that was written has other sizes");
      },
      graph);
}
