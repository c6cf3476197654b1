#include <iterator>

#include <fmt/format.h>

#include "slom/io/g2o.hpp"

namespace slom::io {

namespace g2o {

namespace {

using Text = fmt::memory_buffer;

/// Tags of the plane and of space, and what stands between ids and measurement of a sighting.
template <class Pose>
struct Tags;
template <>
struct Tags<Pose2> {
  static constexpr const char *pose = "VERTEX_SE2", *edge = "EDGE_SE2", *landmark = "VERTEX_XY",
                              *sighting = "EDGE_SE2_XY", *sensor = "";
};
template <>
struct Tags<Pose3> {
  static constexpr const char *pose = "VERTEX_SE3:QUAT", *edge = "EDGE_SE3:QUAT",
                              *landmark = "VERTEX_TRACKXYZ", *sighting = "EDGE_SE3_TRACKXYZ", *sensor = " 0";
};

template <int N>
void append(Text& text, const mtk::vect<N>& point) {
  for (int i = 0; i < N; ++i) fmt::format_to(std::back_inserter(text), " {}", point[i]);
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

template <class Datum>
void appendEdge(Text& text, const char* tag, long from, long to, const char* sensor,
                const Edge<Datum>& edge) {
  fmt::format_to(std::back_inserter(text), "{} {} {}{}", tag, from, to, sensor);
  append(text, edge.measured);
  for (int i = 0; i < Datum::DOF; ++i) {
    for (int j = i; j < Datum::DOF; ++j)
      fmt::format_to(std::back_inserter(text), " {}", edge.information(i, j));
  }
  text.push_back('\n');
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
  if (dim<Pose> == 3 && !graph.sightings.empty())
    text.append(std::string_view("PARAMS_SE3OFFSET 0 0 0 0 0 0 0 1\n"));
  appendVertices(text, poses, T::pose);
  appendVertices(text, landmarks, T::landmark);
  appendFixes(text, poses);
  appendFixes(text, landmarks);
  for (const auto& edge : graph.edges) {
    appendEdge(text, T::edge, poses[std::size_t(edge.from)].id, poses[std::size_t(edge.to)].id, "", edge);
  }
  for (const auto& edge : graph.sightings) {
    appendEdge(text, T::sighting, poses[std::size_t(edge.from)].id, landmarks[std::size_t(edge.to)].id,
               T::sensor, edge);
  }
  return fmt::to_string(text);
}

// A shared library hides instances of templates that are not defined in a public header, unless told otherwise.
template __attribute__((visibility("default"))) std::string toG2o(const PoseGraph<Pose2>&);
template __attribute__((visibility("default"))) std::string toG2o(const PoseGraph<Pose3>&);

}  // namespace slom::io
