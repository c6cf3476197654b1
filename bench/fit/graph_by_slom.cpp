// Pose graphs by SLoM, as in the command `slom graph`.
#include <slom/base/threads.hpp>
#include <slom/io/pose_graph_model.hpp>
#include <slom/solve/block_solver.hpp>

#include "fit/run.hpp"
#include "fit/slom_options.hpp"
#include "fit/stopwatch.hpp"

namespace slom::bench {

namespace {

/// Returns the blocks of all poses and landmarks that are not fixed, and which of them meet.
template <class Pose>
BlockStructure structureOf(const io::PoseGraph<Pose>& graph) {
  BlockStructure structure;
  structure.offset.push_back(0);
  const auto blocksOf = [&](const auto& nodes, int dof) {
    std::vector<int> blocks;
    for (const auto& node : nodes) {
      blocks.push_back(node.fixed ? -1 : structure.blockCount());
      if (!node.fixed) structure.offset.push_back(structure.offset.back() + dof);
    }
    return blocks;
  };
  const std::vector<int> poses = blocksOf(graph.poses, io::dof<Pose>);
  const std::vector<int> landmarks = blocksOf(graph.landmarks, io::dim<Pose>);
  const auto addGroup = [&](const auto& edges, const std::vector<int>& ends) {
    MeasurementGroup group{2, {}};
    for (const auto& edge : edges) {
      group.blocks.push_back(poses[static_cast<std::size_t>(edge.from)]);
      group.blocks.push_back(ends[static_cast<std::size_t>(edge.to)]);
    }
    structure.groups.push_back(std::move(group));
  };
  addGroup(graph.edges, poses);
  addGroup(graph.sightings, landmarks);
  return structure;
}

}  // namespace

template <class Pose>
Run fitBySlom(const io::PoseGraph<Pose>& graph, const Limits& limits) {
  Estimator est;
  est.setThreads(limits.threads);
  const io::PoseGraphModel model{lossOf(limits)};
  const double build = secondsOf([&] { io::insert(est, graph, model); });
  Run run = runOf(est.optimize(stoppingRule(limits)));
  run.build_seconds = build;
  return run;
}
template Run fitBySlom(const io::PoseGraph<io::Pose2>&, const Limits&);
template Run fitBySlom(const io::PoseGraph<io::Pose3>&, const Limits&);

template <class Pose>
Factorization analyzeBySlom(const io::PoseGraph<Pose>& graph) {
  const BlockStructure structure = structureOf(graph);
  Factorization result;
  withThreads(1, [&] {
    BlockSolver solver;
    result.symbolic_seconds = bestSecondsOf([&] { solver.analyze(structure); });
    result.flops = solver.flops();
  });
  return result;
}
template Factorization analyzeBySlom(const io::PoseGraph<io::Pose2>&);
template Factorization analyzeBySlom(const io::PoseGraph<io::Pose3>&);

}  // namespace slom::bench
