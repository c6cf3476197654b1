// Ids resolved to nodes: the vertices, and the ends of each edge.
#include <algorithm>
#include <unordered_map>

#include <fmt/format.h>

#include "io/fault.hpp"
#include "io/g2o/raw_graph.hpp"

namespace slom::io::g2o {

namespace {

enum class Kind { pose, landmark };

const char* nameOf(Kind kind) { return kind == Kind::pose ? "a pose" : "a landmark"; }

/// The meaning of an id.
struct Known {
  Kind kind = Kind::pose;
  int node = 0;
  int line = 0;
};

template <class Pose>
class Resolver {
 public:
  explicit Resolver(RawGraph<Pose>&& raw) : raw_(std::move(raw)), graph_(raw_.graph) {}

  PoseGraph<Pose> run() {
    graph_.has_vertices = !graph_.poses.empty() || !graph_.landmarks.empty();
    graph_.has_fix_lines = !raw_.fixed.empty();
    if (!graph_.has_vertices) makeVertices();
    known_.reserve(graph_.poses.size() + graph_.landmarks.size());
    enter(graph_.poses, Kind::pose);
    enter(graph_.landmarks, Kind::landmark);
    connect(graph_.edges, raw_.edge_ends, Kind::pose);
    connect(graph_.sightings, raw_.sighting_ends, Kind::landmark);
    connect(graph_.bearings, raw_.bearing_ends, Kind::landmark);
    placeSensors();
    connectPriors();
    hold();
    return std::move(graph_);
  }

 private:
  [[noreturn]] void fail(int line, const std::string& what) const {
    failAt("bad-graph", graph_.file, line, what);
  }

  /// Makes a vertex for each id that an edge names, in the order of the ids.
  void makeVertices() {
    for (std::size_t i = 0; i < graph_.edges.size(); ++i) {
      add(graph_.poses, raw_.edge_ends[i].from, graph_.edges[i].line);
      add(graph_.poses, raw_.edge_ends[i].to, graph_.edges[i].line);
    }
    for (std::size_t i = 0; i < graph_.sightings.size(); ++i) {
      add(graph_.poses, raw_.sighting_ends[i].from, graph_.sightings[i].line);
      add(graph_.landmarks, raw_.sighting_ends[i].to, graph_.sightings[i].line);
    }
    for (std::size_t i = 0; i < graph_.bearings.size(); ++i) {
      add(graph_.poses, raw_.bearing_ends[i].from, graph_.bearings[i].line);
      add(graph_.landmarks, raw_.bearing_ends[i].to, graph_.bearings[i].line);
    }
    for (std::size_t i = 0; i < graph_.pose_priors.size(); ++i)
      add(graph_.poses, raw_.pose_priors_of[i].pose, graph_.pose_priors[i].line);
    for (std::size_t i = 0; i < graph_.position_priors.size(); ++i)
      add(graph_.poses, raw_.position_priors_of[i].pose, graph_.position_priors[i].line);
    makeUnique(graph_.poses);
    makeUnique(graph_.landmarks);
  }
  template <class Value>
  static void add(std::vector<Node<Value>>& nodes, std::uint64_t id, int line) {
    Node<Value>& node = nodes.emplace_back();
    node.id = id;
    node.line = line;
  }
  template <class Value>
  static void makeUnique(std::vector<Node<Value>>& nodes) {
    const auto by_id = [](const auto& a, const auto& b) { return a.id < b.id; };
    const auto same_id = [](const auto& a, const auto& b) { return a.id == b.id; };
    std::stable_sort(nodes.begin(), nodes.end(), by_id);
    nodes.erase(std::unique(nodes.begin(), nodes.end(), same_id), nodes.end());
  }

  template <class Value>
  void enter(const std::vector<Node<Value>>& nodes, Kind kind) {
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const auto& node = nodes[i];
      const auto [it, is_new] = known_.try_emplace(node.id, Known{kind, int(i), node.line});
      if (is_new) continue;
      const Known& old = it->second;
      if (graph_.has_vertices) {
        fail(node.line,
             fmt::format("vertex {} is there already, on line {}; remove one of them", node.id, old.line));
      }
      fail(node.line, fmt::format("vertex {} is {} here and {} on line {}; give one of them another id",
                                  node.id, nameOf(kind), nameOf(old.kind), old.line));
    }
  }

  int find(std::uint64_t id, Kind kind, int line) const {
    const auto it = known_.find(id);
    if (it == known_.end()) {
      fail(line, fmt::format("there is no vertex {}; add a line for it, or remove this one", id));
    }
    if (it->second.kind != kind) {
      fail(line, fmt::format("vertex {} must be {} here, but is {}; see line {}", id, nameOf(kind),
                             nameOf(it->second.kind), it->second.line));
    }
    return it->second.node;
  }

  template <class Datum>
  void connect(std::vector<Edge<Datum>>& edges, const std::vector<Ends>& ends, Kind to) const {
    for (std::size_t i = 0; i < edges.size(); ++i) {
      edges[i].from = find(ends[i].from, Kind::pose, edges[i].line);
      edges[i].to = find(ends[i].to, to, edges[i].line);
    }
  }

  /// Returns the index of a sensor. A file need not define a sensor at the origin of the robot.
  int sensorOf(std::uint64_t id) {
    const auto it = sensors_.find(id);
    if (it != sensors_.end()) return it->second;
    graph_.missing_sensors.insert(id);
    return PosePrior<Pose>::robot;
  }

  /// Transforms sightings to the frame of the robot: O^-1 X^-1 l - z = R_O^T (X^-1 l - O z) for a sensor at O.
  void placeSensors() {
    for (std::size_t i = 0; i < graph_.sensors.size(); ++i) {
      const auto [it, is_new] = sensors_.try_emplace(graph_.sensors[i].id, int(i));
      if (is_new) continue;
      fail(graph_.sensors[i].line,
           fmt::format("sensor {} is there already, on line {}; remove one of them", graph_.sensors[i].id,
                       graph_.sensors[std::size_t(it->second)].line));
    }
    for (std::size_t i = 0; i < raw_.sighting_sensors.size(); ++i) {
      const int sensor = sensorOf(raw_.sighting_sensors[i]);
      if (sensor < 0) continue;
      const Pose& offset = graph_.sensors[std::size_t(sensor)].offset;
      if (mtk::difference(offset, Pose()).isZero(0)) continue;
      Edge<Point<Pose>>& sighting = graph_.sightings[i];
      Edge<Point<Pose>> sensed = sighting;
      sensed.from = sensor;
      graph_.as_sensed.emplace(i, sensed);
      const Symmetric<dim<Pose>> R = offset.orient.toRotationMatrix();
      sighting.measured = offset * sensed.measured;
      const Symmetric<dim<Pose>> turned = R * sensed.information * R.transpose();
      sighting.information = (turned + turned.transpose()) / 2;
    }
  }
  void connectPriors() {
    for (std::size_t i = 0; i < graph_.pose_priors.size(); ++i) {
      PosePrior<Pose>& prior = graph_.pose_priors[i];
      prior.pose = find(raw_.pose_priors_of[i].pose, Kind::pose, prior.line);
      if (dim<Pose> == 3) prior.sensor = sensorOf(raw_.pose_priors_of[i].sensor);
    }
    for (std::size_t i = 0; i < graph_.position_priors.size(); ++i) {
      PositionPrior<Pose>& prior = graph_.position_priors[i];
      prior.pose = find(raw_.position_priors_of[i].pose, Kind::pose, prior.line);
    }
  }

  void hold() {
    for (const FixedVertex& fixed : raw_.fixed) {
      const auto it = known_.find(fixed.id);
      if (it == known_.end()) {
        fail(fixed.line,
             fmt::format("there is no vertex {}; add a line for it, or remove this one", fixed.id));
      }
      const auto node = static_cast<std::size_t>(it->second.node);
      (it->second.kind == Kind::pose ? graph_.poses[node].fixed : graph_.landmarks[node].fixed) = true;
    }
  }

  RawGraph<Pose> raw_;
  PoseGraph<Pose>& graph_;
  std::unordered_map<std::uint64_t, Known> known_;
  std::unordered_map<std::uint64_t, int> sensors_;  // indices by id
};

}  // namespace

template <class Pose>
PoseGraph<Pose> resolve(RawGraph<Pose> raw) {
  return Resolver<Pose>(std::move(raw)).run();
}

template PoseGraph<Pose2> resolve(RawGraph<Pose2>);
template PoseGraph<Pose3> resolve(RawGraph<Pose3>);

}  // namespace slom::io::g2o
