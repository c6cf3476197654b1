#include <algorithm>
#include <cstdint>
#include <iterator>
#include <limits>
#include <string>

#include <fmt/format.h>

#include "slom/io/g2o.hpp"

namespace slom::io {

namespace g2o {

namespace {

using Text = fmt::memory_buffer;

/// Tags of the plane and of space.
template <class Pose>
struct Tags;
template <>
struct Tags<Pose2> {
  static constexpr const char *pose = "VERTEX_SE2", *edge = "EDGE_SE2", *landmark = "VERTEX_XY",
                              *sighting = "EDGE_SE2_XY", *prior = "EDGE_PRIOR_SE2";
};
template <>
struct Tags<Pose3> {
  static constexpr const char *pose = "VERTEX_SE3:QUAT", *edge = "EDGE_SE3:QUAT",
                              *landmark = "VERTEX_TRACKXYZ", *sighting = "EDGE_SE3_TRACKXYZ",
                              *prior = "EDGE_SE3_PRIOR";
};

template <int N>
void append(Text& text, const mtk::vect<N>& point) {
  for (int i = 0; i < N; ++i) fmt::format_to(std::back_inserter(text), " {}", point[i]);
}
void append(Text& text, const mtk::SO2<>& direction) {
  fmt::format_to(std::back_inserter(text), " {}", direction.angle());
}
void append(Text& text, const Pose2& pose) {
  append(text, pose.pos);
  fmt::format_to(std::back_inserter(text), " {}", pose.orient.angle());
}
void append(Text& text, const Pose3& pose) {
  append(text, pose.pos);
  const auto& R = pose.orient;
  fmt::format_to(std::back_inserter(text), " {} {} {} {}", R.x(), R.y(), R.z(), R.w());
}

template <class Value>
void appendVertices(Text& text, const std::vector<Node<Value>>& nodes, const char* tag) {
  for (const Node<Value>& node : nodes) {
    fmt::format_to(std::back_inserter(text), "{} {}", tag, node.id);
    append(text, node.value);
    text.push_back('\n');
  }
}

template <class Value>
void appendFixes(Text& text, const std::vector<Node<Value>>& nodes) {
  for (const Node<Value>& node : nodes) {
    if (node.fixed) fmt::format_to(std::back_inserter(text), "FIX {}\n", node.id);
  }
}

/// Appends a measurement and its information, to the end of the line.
template <class Datum, int N>
void appendMeasured(Text& text, const Datum& measured, const Symmetric<N>& information) {
  append(text, measured);
  for (int i = 0; i < N; ++i) {
    for (int j = i; j < N; ++j) fmt::format_to(std::back_inserter(text), " {}", information(i, j));
  }
  text.push_back('\n');
}

template <class Datum>
void appendEdge(Text& text, const char* tag, std::uint64_t from, std::uint64_t to, const std::string& sensor,
                const Edge<Datum>& edge) {
  fmt::format_to(std::back_inserter(text), "{} {} {}{}", tag, from, to, sensor);
  appendMeasured(text, edge.measured, edge.information);
}

/// Appends the sensors of the file, and one at the origin of the robot if sightings need it. Returns the id of the
/// latter.
std::uint64_t appendSensors(Text& text, const PoseGraph<Pose3>& graph) {
  std::uint64_t free_id = 0;
  const Sensor<Pose3>* at_origin = nullptr;
  for (const Sensor<Pose3>& sensor : graph.sensors) {
    fmt::format_to(std::back_inserter(text), "PARAMS_SE3OFFSET {}", sensor.id);
    append(text, sensor.offset);
    text.push_back('\n');
    if (at_origin == nullptr && mtk::difference(sensor.offset, Pose3()).isZero(0)) at_origin = &sensor;
    if (sensor.id != std::numeric_limits<std::uint64_t>::max()) free_id = std::max(free_id, sensor.id + 1);
  }
  if (at_origin != nullptr) return at_origin->id;
  const bool is_needed = graph.sightings.size() > graph.as_sensed.size() ||
                         std::any_of(graph.pose_priors.begin(), graph.pose_priors.end(),
                                     [](const auto& prior) { return prior.sensor < 0; });
  if (is_needed) fmt::format_to(std::back_inserter(text), "PARAMS_SE3OFFSET {} 0 0 0 0 0 0 1\n", free_id);
  return free_id;
}

/// Appends edges, sightings, bearings and priors. `origin`: the sensor at the origin of the robot.
template <class Pose>
void appendMeasurements(Text& text, const PoseGraph<Pose>& graph, std::uint64_t origin) {
  using T = Tags<Pose>;
  const auto pose = [&](int i) { return graph.poses[std::size_t(i)].id; };
  const auto landmark = [&](int i) { return graph.landmarks[std::size_t(i)].id; };
  const auto sensorText = [&](int sensor) {
    if (dim<Pose> == 2) return std::string();
    return std::string(" ") + std::to_string(sensor < 0 ? origin : graph.sensors[std::size_t(sensor)].id);
  };
  for (const auto& edge : graph.edges) appendEdge(text, T::edge, pose(edge.from), pose(edge.to), "", edge);
  for (std::size_t i = 0; i < graph.sightings.size(); ++i) {
    const auto& sighting = graph.sightings[i];
    const auto sensed = graph.as_sensed.find(i);
    const bool is_sensed = sensed != graph.as_sensed.end();
    appendEdge(text, T::sighting, pose(sighting.from), landmark(sighting.to),
               sensorText(is_sensed ? sensed->second.from : -1), is_sensed ? sensed->second : sighting);
  }
  for (const auto& bearing : graph.bearings)
    appendEdge(text, "EDGE_BEARING_SE2_XY", pose(bearing.from), landmark(bearing.to), "", bearing);
  for (const auto& prior : graph.pose_priors) {
    fmt::format_to(std::back_inserter(text), "{} {}{}", T::prior, pose(prior.pose), sensorText(prior.sensor));
    appendMeasured(text, prior.measured, prior.information);
  }
  for (const auto& prior : graph.position_priors) {
    fmt::format_to(std::back_inserter(text), "EDGE_PRIOR_SE2_XY {}", pose(prior.pose));
    appendMeasured(text, prior.measured, prior.information);
  }
}

}  // namespace
}  // namespace g2o

template <class Pose>
std::string toG2o(const PoseGraph<Pose>& graph) {
  using namespace g2o;
  using T = Tags<Pose>;
  const auto& poses = graph.poses;
  const auto& landmarks = graph.landmarks;
  Text text;
  std::uint64_t origin = 0;
  if constexpr (dim<Pose> == 3) origin = appendSensors(text, graph);
  appendVertices(text, poses, T::pose);
  appendVertices(text, landmarks, T::landmark);
  appendFixes(text, poses);
  appendFixes(text, landmarks);
  appendMeasurements(text, graph, origin);
  return fmt::to_string(text);
}

// A shared library hides instances of templates not defined in a public header. This attribute exports them.
template __attribute__((visibility("default"))) std::string toG2o(const PoseGraph<Pose2>&);
template __attribute__((visibility("default"))) std::string toG2o(const PoseGraph<Pose3>&);

}  // namespace slom::io
