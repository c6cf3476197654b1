// The RSS of a pose graph computed another way: with Eigen's transforms, edge by edge.
#pragma once

#include <Eigen/Geometry>

#include "graph/pose_graph.hpp"

namespace slom::app::graph::testing {

inline Eigen::Isometry2d transform(const Pose2& pose) {
  Eigen::Isometry2d T = Eigen::Isometry2d::Identity();
  T.translate(Eigen::Vector2d(pose.pos)).rotate(pose.orient.angle());
  return T;
}
inline Eigen::Isometry3d transform(const Pose3& pose) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translate(Eigen::Vector3d(pose.pos)).rotate(pose.orient.quaternion());
  return T;
}

/// Returns the error of an edge: translation and rotation of z^-1 (a^-1 b).
inline Eigen::Vector3d errorOf(const Eigen::Isometry2d& T, bool) {
  const Eigen::Rotation2Dd R(T.linear());
  return {T.translation()[0], T.translation()[1], R.smallestAngle()};
}
inline Eigen::Matrix<double, 6, 1> errorOf(const Eigen::Isometry3d& T, bool quaternion) {
  Eigen::Quaterniond q(T.linear());
  if (q.w() < 0) q.coeffs() *= -1;
  const Eigen::AngleAxisd turn(q);
  Eigen::Matrix<double, 6, 1> error;
  error << T.translation(),
      (quaternion ? Eigen::Vector3d(q.vec()) : Eigen::Vector3d(turn.angle() * turn.axis()));
  return error;
}

template <class Pose>
double rssOf(const PoseGraph<Pose>& graph, bool quaternion = false) {
  double rss = 0;
  const auto pose = [&](int i) { return transform(graph.poses[std::size_t(i)].value); };
  for (const auto& edge : graph.edges) {
    const auto error =
        errorOf(transform(edge.measured).inverse() * (pose(edge.from).inverse() * pose(edge.to)), quaternion);
    rss += error.dot(edge.information * error);
  }
  for (const auto& sighting : graph.sightings) {
    const Eigen::Matrix<double, dim<Pose>, 1> point = graph.landmarks[std::size_t(sighting.to)].value;
    const Eigen::Matrix<double, dim<Pose>, 1> error =
        pose(sighting.from).inverse() * point - sighting.measured;
    rss += error.dot(sighting.information * error);
  }
  return rss;
}

/// Returns the largest relative decrease of the RSS if one number of a free vertex moves by `step`.
template <class Pose>
double possibleDecrease(PoseGraph<Pose> graph, double step, bool quaternion = false) {
  const double rss = rssOf(graph, quaternion);
  double best = 0;
  const auto try_all = [&](auto& nodes) {
    for (auto& node : nodes) {
      if (node.fixed) continue;
      const auto value = node.value;
      for (int i = 0; i < mtk::DOF_v<decltype(node.value)>; ++i) {
        for (const double d : {-step, step}) {
          Eigen::Matrix<double, mtk::DOF_v<decltype(node.value)>, 1> delta;
          delta.setZero();
          delta[i] = d;
          mtk::boxplus(node.value, delta);
          best = std::max(best, (rss - rssOf(graph, quaternion)) / rss);
          node.value = value;
        }
      }
    }
  };
  try_all(graph.poses);
  try_all(graph.landmarks);
  return best;
}

}  // namespace slom::app::graph::testing
