#include "graph/initialization/start.hpp"

#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

#include <slom/initialize.hpp>

#include "error.hpp"

namespace slom::app::graph {

namespace {

constexpr Start all_starts[] = {Start::given, Start::odometry, Start::spanning_tree, Start::chordal,
                                Start::build_up};

/// Why no start is found, where no edge leads to the pose `id`.
std::string unreachedText(const std::string& file, long id, const std::string& init) {
  if (init == optionOf(Start::odometry)) {
    return fmt::format(
        "--init odometry: no chain of edges i, i+1 leads from a fixed pose to pose {} of {}; use --init "
        "spanning-tree",
        id, file);
  }
  return fmt::format(
      "--init {}: no edge between poses leads to pose {} of {}, which landmarks alone connect with the rest; "
      "add an edge, or vertices for all",
      init, id, file);
}

/// The chain of edges whose ids, not indices, follow each other.
template <class Pose>
void alongIds(PoseGraph<Pose>& graph) {
  PoseGraph<Pose> chain;
  chain.poses = graph.poses;
  const auto id = [&](int pose) { return graph.poses[std::size_t(pose)].id; };
  for (const auto& edge : graph.edges) {
    if (std::labs(id(edge.from) - id(edge.to)) == 1) chain.edges.push_back(edge);
  }
  initialize::alongSpanningTree(chain);
  graph.poses = chain.poses;
  initialize::placeLandmarks(graph);
}

template <class Pose>
void findOne(PoseGraph<Pose>& graph, Start start, const GraphModel& model) {
  start == Start::odometry ? alongIds(graph) : initialize::findStart(graph, start, model);
}

template <class Pose>
StartFound findBest(PoseGraph<Pose>& graph, const GraphModel& model) {
  std::vector<Start> candidates{Start::odometry, Start::spanning_tree, Start::chordal};
  if (graph.has_vertices) candidates.insert(candidates.begin(), Start::given);
  if (!graph.sightings.empty()) candidates.push_back(Start::build_up);
  const initialize::Choice choice = initialize::chooseStart(
      graph, candidates, [&](PoseGraph<Pose>& g, Start start) { findOne(g, start, model); }, model);
  StartFound found{choice.start, {}};
  for (const auto& [start, rss] : choice.costs) {
    if (std::isfinite(rss)) found.tried.push_back(start);
  }
  return found;
}

}  // namespace

const char* optionOf(Start start) {
  switch (start) {
    case Start::given:
      return "file";
    case Start::odometry:
      return "odometry";
    case Start::spanning_tree:
      return "spanning-tree";
    case Start::chordal:
      return "chordal";
    case Start::build_up:
      return "build-up";
  }
  return "";
}

std::optional<Start> parseStart(const std::string& text) {
  if (text == "auto") return std::nullopt;
  for (const Start start : all_starts) {
    if (text == optionOf(start)) return start;
  }
  throw UserError(fmt::format(
      "--init {}: the starts are auto, file, odometry, spanning-tree, chordal and build-up", text));
}

template <class Pose>
StartFound findStart(PoseGraph<Pose>& graph, std::optional<Start> start, const GraphModel& model) {
  if (start == Start::given && !graph.has_vertices) {
    throw UserError("--init file: " + graph.file +
                    " has no vertices; leave the option out, or choose odometry, spanning-tree, chordal or "
                    "build-up");
  }
  const std::string init = start ? optionOf(*start) : "auto";
  try {
    if (!start) return findBest(graph, model);
    findOne(graph, *start, model);
    return {*start, {*start}};
  } catch (const initialize::Unreached& error) {
    throw UserError(unreachedText(graph.file, graph.poses[std::size_t(error.pose())].id, init));
  } catch (const mtk::Error& error) {
    throw UserError("--init " + init + ": " + std::string(error.sentence()));
  }
}

template StartFound findStart(PoseGraph<Pose2>&, std::optional<Start>, const GraphModel&);
template StartFound findStart(PoseGraph<Pose3>&, std::optional<Start>, const GraphModel&);

}  // namespace slom::app::graph
