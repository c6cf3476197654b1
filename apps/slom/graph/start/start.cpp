#include "graph/start/start.hpp"

#include "error.hpp"
#include "graph/start/chordal.hpp"
#include "graph/start/tree.hpp"

namespace slom::app::graph {

namespace {

/// Each landmark where the first pose that sees it puts it.
template <class Pose>
void placeLandmarks(PoseGraph<Pose>& graph) {
  std::vector<char> is_placed(graph.landmarks.size(), 0);
  for (const auto& sighting : graph.sightings) {
    auto& landmark = graph.landmarks[std::size_t(sighting.to)];
    if (landmark.held || is_placed[std::size_t(sighting.to)]++ != 0) continue;
    landmark.value = graph.poses[std::size_t(sighting.from)].value * sighting.measured;
  }
}

}  // namespace

const char* toString(Init init) {
  switch (init) {
    case Init::file:
      return "file";
    case Init::odometry:
      return "odometry";
    case Init::spanning_tree:
      return "spanning-tree";
    case Init::chordal:
      return "chordal";
  }
  return "";
}

template <class Pose>
void findStart(PoseGraph<Pose>& graph, Init init) {
  if (init == Init::file) {
    if (graph.has_vertices) return;
    throw UserError("--init file: " + graph.file +
                    " has no vertices; leave the option out, or choose odometry, spanning-tree or chordal");
  }
  composeAlongTree(graph, init);
  if (init == Init::chordal) relaxChordally(graph);
  placeLandmarks(graph);
}

template void findStart(PoseGraph<Pose2>&, Init);
template void findStart(PoseGraph<Pose3>&, Init);

}  // namespace slom::app::graph
