#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "io/fault.hpp"
#include "slom/io/g2o.hpp"

namespace slom::io {

namespace {

using ToroText = fmt::memory_buffer;

void appendNumber(ToroText& text, double x) { fmt::format_to(std::back_inserter(text), " {}", x); }

void appendToro(ToroText& text, const Pose2& pose) {
  for (const double x : {pose.pos[0], pose.pos[1], pose.orient.angle()}) appendNumber(text, x);
}

/// Returns roll, pitch and yaw of Rz(yaw) Ry(pitch) Rx(roll). Each angle is computed from what the previous ones leave.
/// So the product is R even if yaw and roll turn about the same axis.
mtk::vect<3> eulerAngles(const mtk::SO3<>& R) {
  const auto whole = R.toRotationMatrix();
  const double yaw = std::atan2(whole(1, 0), whole(0, 0));
  const auto rest = (mtk::SO3<>::exp(mtk::vect<3>(0, 0, -yaw)) * R).toRotationMatrix();
  return {std::atan2(-rest(1, 2), rest(1, 1)), std::atan2(-rest(2, 0), rest(0, 0)), yaw};
}
void appendToro(ToroText& text, const Pose3& pose) {
  for (int i = 0; i < 3; ++i) appendNumber(text, pose.pos[i]);
  const mtk::vect<3> angles = eulerAngles(pose.orient);
  for (int i = 0; i < 3; ++i) appendNumber(text, angles[i]);
}

/// Appends `I11 I12 I22 I33 I13 I23`.
void appendToro(ToroText& text, const Symmetric<3>& I) {
  for (const double x : {I(0, 0), I(0, 1), I(1, 1), I(2, 2), I(0, 2), I(1, 2)}) appendNumber(text, x);
}
/// Appends the upper triangle, row by row.
void appendToro(ToroText& text, const Symmetric<6>& I) {
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) appendNumber(text, I(i, j));
  }
}

}  // namespace

template <class Pose>
std::string toToro(const PoseGraph<Pose>& graph) {
  if (!graph.landmarks.empty()) {
    fail("no-toro",
         graph.file + ": TORO's format has no landmarks, and the graph has " +
             std::to_string(graph.landmarks.size()) + "; write it in g2o's",
         graph.file);
  }
  if (!graph.pose_priors.empty() || !graph.position_priors.empty())
    fail("no-toro", graph.file + ": TORO's format has no priors; write the graph in g2o's", graph.file);
  ToroText text;
  for (const Node<Pose>& node : graph.poses) {
    fmt::format_to(std::back_inserter(text), "VERTEX{} {}", dim<Pose>, node.id);
    appendToro(text, node.value);
    text.push_back('\n');
  }
  for (const Node<Pose>& node : graph.poses) {
    if (node.fixed) fmt::format_to(std::back_inserter(text), "FIX {}\n", node.id);
  }
  for (const Edge<Pose>& edge : graph.edges) {
    fmt::format_to(std::back_inserter(text), "EDGE{} {} {}", dim<Pose>,
                   graph.poses[std::size_t(edge.from)].id, graph.poses[std::size_t(edge.to)].id);
    appendToro(text, edge.measured);
    appendToro(text, edge.information);
    text.push_back('\n');
  }
  return fmt::to_string(text);
}

// A shared library hides instances of templates not defined in a public header. This attribute exports them.
template __attribute__((visibility("default"))) std::string toToro(const PoseGraph<Pose2>&);
template __attribute__((visibility("default"))) std::string toToro(const PoseGraph<Pose3>&);

}  // namespace slom::io
