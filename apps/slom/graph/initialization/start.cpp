#include "graph/initialization/start.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include <Eigen/LU>
#include <fmt/format.h>

#include <slom/initialize.hpp>

#include "error.hpp"
#include "graph/initialization/roots.hpp"

namespace slom::app::graph {

namespace {

constexpr Start all_starts[] = {Start::given, Start::odometry, Start::spanning_tree, Start::chordal,
                                Start::build_up};

/// Returns why no start is found: no edge leads to the pose `id`.
std::string unreachedText(const std::string& file, std::uint64_t id, const std::string& init) {
  if (init == optionOf(Start::odometry)) {
    return fmt::format(
        "--init odometry: no chain of edges i, i+1 leads from a fixed pose to pose {} of {}; use --init "
        "spanning-tree",
        id, file);
  }
  return fmt::format(
      "--init {}: no edge between poses leads to pose {} of {}, which only landmarks connect with the rest; "
      "add an edge, or add vertices for all",
      init, id, file);
}

/// Composes the chain of edges between consecutive ids (not indices).
template <class Pose>
void alongIds(PoseGraph<Pose>& graph) {
  PoseGraph<Pose> chain;
  chain.poses = graph.poses;
  const auto id = [&](int pose) { return graph.poses[std::size_t(pose)].id; };
  for (const auto& edge : graph.edges) {
    const std::uint64_t a = id(edge.from), b = id(edge.to);
    if ((a > b ? a - b : b - a) == 1) chain.edges.push_back(edge);
  }
  initialize::alongSpanningTree(chain);
  graph.poses = chain.poses;
  initialize::placeLandmarks(graph);
}

/// Places landmarks known only by bearings where their rays meet, or on the first ray if the rays are parallel.
template <class Pose>
void placeByBearings(PoseGraph<Pose>& graph) {
  if constexpr (dim<Pose> == 2) {
    struct Rays {
      bool is_wanted = true;
      Eigen::Matrix2d N = Eigen::Matrix2d::Zero();  // sum of n n^T over normals n
      Eigen::Vector2d b = Eigen::Vector2d::Zero();
      std::optional<Eigen::Vector2d> first;
    };
    std::vector<Rays> rays(graph.landmarks.size());
    for (std::size_t l = 0; l < rays.size(); ++l) rays[l].is_wanted = !graph.landmarks[l].fixed;
    for (const auto& sighting : graph.sightings) rays[std::size_t(sighting.to)].is_wanted = false;
    for (const auto& bearing : graph.bearings) {
      Rays& own = rays[std::size_t(bearing.to)];
      const Pose2& pose = graph.poses[std::size_t(bearing.from)].value;
      const mtk::vect<2> along = (pose.orient * bearing.measured) * mtk::vect<2>(1, 0);
      const Eigen::Vector2d normal(-along[1], along[0]);
      own.N += normal * normal.transpose();
      own.b += normal * normal.dot(pose.pos);
      if (!own.first) own.first = Eigen::Vector2d(pose.pos + along);
    }
    constexpr double parallel = 1e-6;
    for (std::size_t l = 0; l < rays.size(); ++l) {
      const Rays& own = rays[l];
      if (!own.is_wanted || !own.first) continue;
      const double determinant = own.N.determinant();
      const Eigen::Matrix2d adjugate{{own.N(1, 1), -own.N(0, 1)}, {-own.N(1, 0), own.N(0, 0)}};
      const bool do_meet = determinant > parallel * own.N.trace() * own.N.trace();
      graph.landmarks[l].value = do_meet ? Eigen::Vector2d(adjugate * own.b / determinant) : *own.first;
    }
  }
}

template <class Pose>
void findOne(PoseGraph<Pose>& graph, const Roots<Pose>& roots, Start start, const GraphModel& model) {
  if (start == Start::given) roots.restore(graph);
  start == Start::odometry ? alongIds(graph) : initialize::findStart(graph, start, model);
  if (start != Start::given) placeByBearings(graph);
}

template <class Pose>
StartFound findBest(PoseGraph<Pose>& graph, const Roots<Pose>& roots, const GraphModel& model) {
  std::vector<Start> candidates{Start::odometry, Start::spanning_tree, Start::chordal};
  if (graph.has_vertices) candidates.insert(candidates.begin(), Start::given);
  if (!graph.sightings.empty()) candidates.push_back(Start::build_up);
  const initialize::Choice choice = initialize::chooseStart(
      graph, candidates, [&](PoseGraph<Pose>& g, Start start) { findOne(g, roots, start, model); }, model);
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
      "--init {}: unknown start; give auto, file, odometry, spanning-tree, chordal or build-up", text));
}

template <class Pose>
StartFound findStart(PoseGraph<Pose>& graph, std::optional<Start> start, const GraphModel& model) {
  if (start == Start::given && !graph.has_vertices) {
    throw UserError("--init file: " + graph.file +
                    " has no vertices; leave the option out, or choose odometry, spanning-tree, chordal or "
                    "build-up");
  }
  const std::string init = start ? optionOf(*start) : "auto";
  const Roots<Pose> roots(graph);
  try {
    if (!start) return findBest(graph, roots, model);
    findOne(graph, roots, *start, model);
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
