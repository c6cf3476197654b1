#include "graph/initialization/gauge.hpp"

#include <numeric>
#include <vector>

#include <fmt/format.h>

#include "error.hpp"

namespace slom::app::graph {

namespace {

/// Sets that are joined pair by pair.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t size) : parent_(size) { std::iota(parent_.begin(), parent_.end(), 0); }
  /// The smallest member of the set that `i` is in.
  int find(int i) {
    while (parent_[std::size_t(i)] != i)
      i = parent_[std::size_t(i)] = parent_[std::size_t(parent_[std::size_t(i)])];
    return i;
  }
  void join(int a, int b) {
    a = find(a);
    b = find(b);
    parent_[std::size_t(std::max(a, b))] = std::min(a, b);
  }

 private:
  std::vector<int> parent_;
};

/// A connected component of the graph; messages call it a part.
struct Component {
  int first = 0;  ///< its first vertex: a pose where it has one; landmarks count after the poses
  int vertices = 0;
  int fixed_poses = 0;
};

template <class Pose>
std::vector<Component> componentsOf(const PoseGraph<Pose>& graph) {
  const int poses = int(graph.poses.size());
  DisjointSets sets(graph.poses.size() + graph.landmarks.size());
  for (const auto& edge : graph.edges) sets.join(edge.from, edge.to);
  for (const auto& sighting : graph.sightings) sets.join(sighting.from, poses + sighting.to);
  std::vector<Component> components;
  std::vector<int> component_of_first(graph.poses.size() + graph.landmarks.size(), -1);
  for (int i = 0; i < int(component_of_first.size()); ++i) {
    const int first = sets.find(i);
    int& component = component_of_first[std::size_t(first)];
    if (component < 0) {
      component = int(components.size());
      components.push_back({first});
    }
    ++components[std::size_t(component)].vertices;
    if (i < poses && graph.poses[std::size_t(i)].fixed) ++components[std::size_t(component)].fixed_poses;
  }
  return components;
}

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

/// `open` are the components without a fixed pose.
template <class Pose>
[[noreturn]] void refuse(const PoseGraph<Pose>& graph, std::size_t parts,
                         const std::vector<Component>& open) {
  constexpr std::size_t most_parts = 5;
  std::string names;
  for (std::size_t i = 0; i < std::min(open.size(), most_parts); ++i) {
    names += fmt::format("{}that of {} ({})", i == 0 ? "" : ", ", nameOf(graph, open[i].first),
                         open[i].vertices == 1 ? "1 vertex" : fmt::format("{} vertices", open[i].vertices));
  }
  throw UserError(
      fmt::format("{}: the graph falls into {} parts that no edge connects, and {} no fixed pose: {}{}; add "
                  "edges between them, add "
                  "a line FIX for a pose of each, or give --hold-parts, which holds the first vertex of each",
                  graph.file, parts, open.size() == 1 ? "1 holds" : fmt::format("{} hold", open.size()),
                  names, open.size() > most_parts ? ", ..." : ""));
}

/// Without vertices nothing says how fixed poses lie to each other.
template <class Pose>
void requireKnownPlaces(const PoseGraph<Pose>& graph, const std::vector<Component>& components) {
  if (graph.has_vertices) return;
  for (const Component& component : components) {
    if (component.fixed_poses < 2) continue;
    throw UserError(
        fmt::format("{}: {} poses are fixed, but the file has no vertices that say where they are; fix one "
                    "of them, or add vertices",
                    graph.file, component.fixed_poses));
  }
}

}  // namespace

template <class Pose>
std::string fixGauge(PoseGraph<Pose>& graph, bool hold_parts) {
  std::vector<Component> components = componentsOf(graph);
  requireKnownPlaces(graph, components);
  std::string fixed;
  if (!graph.has_fix_lines) {
    fix(graph, 0);
    components.front().fixed_poses = 1;
    fixed = nameOf(graph, 0);
  }
  std::vector<Component> open;
  for (const Component& component : components) {
    if (component.fixed_poses == 0) open.push_back(component);
  }
  if (open.empty()) return fixed;
  if (!hold_parts) refuse(graph, components.size(), open);
  for (const Component& component : open) fix(graph, component.first);
  if (!fixed.empty()) fixed += " and ";
  return fixed + (open.size() == 1 ? nameOf(graph, open.front().first)
                                   : fmt::format("the first vertex of {} more parts", open.size()));
}

template std::string fixGauge(PoseGraph<Pose2>&, bool);
template std::string fixGauge(PoseGraph<Pose3>&, bool);

}  // namespace slom::app::graph
