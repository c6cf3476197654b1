/// PoseGraph: a map before the fit, with poses, landmarks and relative measurements between them.
///
///     slom::initialize::PoseGraph<Pose, mtk::vect<2>> graph;
///     const int a = graph.addPose(Pose(), true), b = graph.addPose();
///     graph.addEdge(a, b, a_T_b, information);
///     const int l = graph.addLandmark();
///     graph.addSighting(b, l, l_in_b);
///
/// The functions of slom/initialize.hpp find start values for it. They accept any structure with these members: `poses`
/// and `landmarks`, whose elements have `value` and `fixed`; `edges` and `sightings`, whose elements have `from`, `to`,
/// `measured` and `information`.
///
/// A pose is world_T_body. The datum of an edge is a^-1 b, that of a sighting a^-1 l. A pose type must have `a * b`,
/// `a.inverse()` and, if there are landmarks, `a * landmark`. mtk::trafo has them; other types may be used, too.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "mtk/manifold.hpp"
#include "mtk/types/vect.hpp"

namespace slom::initialize {

/// A pose or a landmark.
template <class Value>
struct Node {
  Value value = Value();
  bool fixed = false;  ///< keeps its value, so that the map does not float
};

/// A measurement between two nodes, with its information matrix.
template <class Datum>
struct Edge {
  using Information = Eigen::Matrix<double, mtk::DOF_v<Datum>, mtk::DOF_v<Datum>, Eigen::DontAlign>;

  int from = 0;  ///< index of the observing pose
  int to = 0;    ///< index of the observed pose or landmark
  Datum measured;
  /// Inverse of the datum's covariance, in the order of its tangent space.
  Information information = Information::Identity();
};

/// A pose graph in memory, for maps that do not come from files.
template <class PoseType, class LandmarkType = mtk::vect<2>>
struct PoseGraph {
  using Pose = PoseType;
  using Landmark = LandmarkType;

  std::vector<Node<Pose>> poses;
  std::vector<Node<Landmark>> landmarks;
  std::vector<Edge<Pose>> edges;
  std::vector<Edge<Landmark>> sightings;

  /// Adds a pose and returns its index. If no pose is fixed, the first one keeps its value.
  int addPose(const Pose& value = Pose(), bool fixed = false) {
    poses.push_back({value, fixed});
    return static_cast<int>(poses.size()) - 1;
  }
  /// Adds a landmark and returns its index among the landmarks.
  int addLandmark(const Landmark& value = Landmark(), bool fixed = false) {
    landmarks.push_back({value, fixed});
    return static_cast<int>(landmarks.size()) - 1;
  }
  /// Adds a measured relative pose, from^-1 to.
  void addEdge(int from, int to, const Pose& measured,
               const typename Edge<Pose>::Information& information = Edge<Pose>::Information::Identity()) {
    edges.push_back({from, to, measured, information});
  }
  /// Adds a measured landmark in the frame of a pose.
  void addSighting(
      int from, int to, const Landmark& measured,
      const typename Edge<Landmark>::Information& information = Edge<Landmark>::Information::Identity()) {
    sightings.push_back({from, to, measured, information});
  }
};

}  // namespace slom::initialize
