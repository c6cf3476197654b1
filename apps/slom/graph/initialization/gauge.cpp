#include "graph/initialization/gauge.hpp"

#include <cmath>

#include <fmt/format.h>

#include "error.hpp"
#include "graph/initialization/components.hpp"
#include "text.hpp"

namespace slom::app::graph {

namespace {

template <class Pose>
void fix(PoseGraph<Pose>& graph, int vertex) {
  const std::size_t v = std::size_t(vertex), poses = graph.poses.size();
  (v < poses ? graph.poses[v].fixed : graph.landmarks[v - poses].fixed) = true;
}

template <class Pose>
std::string nameOf(const PoseGraph<Pose>& graph, int vertex) {
  const std::size_t v = std::size_t(vertex), poses = graph.poses.size();
  return v < poses ? fmt::format("pose {}", graph.poses[v].id)
                   : fmt::format("landmark {}", graph.landmarks[v - poses].id);
}

/// Throws the error for `open`, the components without anything fixed.
template <class Pose>
[[noreturn]] void refuse(const PoseGraph<Pose>& graph, std::size_t parts,
                         const std::vector<Component<Pose>>& open) {
  constexpr std::size_t most_parts = 5;
  std::string names;
  for (std::size_t i = 0; i < std::min(open.size(), most_parts); ++i) {
    names += fmt::format("{}the part of {} ({})", i == 0 ? "" : ", ", nameOf(graph, open[i].first),
                         open[i].vertices == 1 ? "1 vertex" : fmt::format("{} vertices", open[i].vertices));
  }
  throw UserError(
      fmt::format("{}: the graph has {} parts that no edge connects, and {} no fixed pose: {}{}; add "
                  "edges between them, add "
                  "a line FIX for a pose of each, or pass --hold-parts to fix the first vertex of each",
                  graph.file, parts, open.size() == 1 ? "1 has" : fmt::format("{} have", open.size()), names,
                  open.size() > most_parts ? ", ..." : ""));
}

/// Throws if several nodes are fixed in a file without vertices: then their relative positions are unknown.
template <class Pose>
void requireKnownPlaces(const PoseGraph<Pose>& graph, const std::vector<Component<Pose>>& components) {
  if (graph.has_vertices) return;
  for (const Component<Pose>& component : components) {
    const auto landmarks = std::size_t(component.fixed_landmarks);
    if (std::size_t(component.fixed_poses) + landmarks < 2) continue;
    std::vector<std::string> what;
    if (component.fixed_poses > 0) what.push_back(plural(std::size_t(component.fixed_poses), "pose"));
    if (landmarks > 0) what.push_back(plural(landmarks, "landmark"));
    throw UserError(
        fmt::format("{}: {} are fixed, but the file has no vertices that give their places; fix one "
                    "of them, or add vertices",
                    graph.file, listed(what, ", ", " and ")));
  }
}

/// Returns the component of a rotation that changes most when the world turns about `axis`.
std::string componentAbout(const Eigen::Vector3d& axis, const mtk::SO3<>& orient) {
  int most = 0;
  (orient.toRotationMatrix().transpose() * axis).cwiseAbs().maxCoeff(&most);
  return fmt::format("orient.{}", "xyz"[most]);
}
std::string componentAbout(const Eigen::Vector2d&, const mtk::SO2<>&) { return "orient"; }

/// Returns `landmark 2, landmark 3, ...`.
std::string placesText(const std::vector<std::string>& names) {
  constexpr std::size_t most = 3;
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), most); ++i) text += (i == 0 ? "" : ", ") + names[i];
  return text + (names.size() > most ? ", ..." : "");
}

/// Holds the rotations that the known places of each component leave free, and describes them.
template <class Pose>
void holdRotations(const PoseGraph<Pose>& graph, const std::vector<Component<Pose>>& components,
                   Gauge& gauge) {
  for (const Component<Pose>& component : components) {
    if (component.isTied() || component.isOpen() || !component.hasPoses(graph)) continue;
    const FreeRotation<Pose> rotation = freeRotationOf(component);
    if (rotation.dimension == 0) continue;
    const auto& pose = graph.poses[std::size_t(component.first)];
    const bool is_about_line = dim<Pose> == 3 && rotation.dimension == 1;
    gauge.rotations.push_back(
        {component.first, is_about_line ? componentAbout(rotation.axis, pose.value.orient) : "orient"});
    gauge.rotations_text +=
        fmt::format("{}the {} of pose {}, because the map can turn about {}{}",
                    gauge.rotations_text.empty() ? "" : " and ", dim<Pose> == 2 ? "heading" : "rotation",
                    pose.id, is_about_line ? "the line through " : "", placesText(component.names));
  }
}

}  // namespace

template <class Pose>
Gauge fixGauge(PoseGraph<Pose>& graph, bool hold_parts) {
  std::vector<Component<Pose>> components = componentsOf(graph);
  requireKnownPlaces(graph, components);
  Gauge gauge;
  if (!graph.has_fix_lines && components.front().isOpen()) {
    fix(graph, 0);
    components.front().fixed_poses = 1;
    gauge.text = nameOf(graph, 0);
  }
  std::vector<Component<Pose>> open;
  for (const Component<Pose>& component : components) {
    if (component.isOpen()) open.push_back(component);
  }
  if (!open.empty()) {
    if (!hold_parts) refuse(graph, components.size(), open);
    for (const Component<Pose>& component : open) fix(graph, component.first);
    if (!gauge.text.empty()) gauge.text += " and ";
    gauge.text += open.size() == 1 ? nameOf(graph, open.front().first)
                                   : fmt::format("the first vertex of {} more parts", open.size());
  }
  holdRotations(graph, components, gauge);
  return gauge;
}

template Gauge fixGauge(PoseGraph<Pose2>&, bool);
template Gauge fixGauge(PoseGraph<Pose3>&, bool);

}  // namespace slom::app::graph
