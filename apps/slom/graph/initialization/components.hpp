// Connected parts of a graph, and what is fixed in each.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "graph/pose_graph.hpp"

namespace slom::app::graph {

/// A connected component of the graph; messages call it a part.
template <class Pose>
struct Component {
  using Place = Eigen::Matrix<double, dim<Pose>, 1>;

  int first = 0;  ///< its first vertex: a pose if it has one; landmarks count after poses
  int vertices = 0;
  int fixed_poses = 0, fixed_landmarks = 0;
  int pose_priors = 0;
  /// Known places: those of fixed landmarks, and of poses with a position measured in the world. Names such as
  /// `landmark 2`.
  std::vector<Place> places;
  std::vector<std::string> names;

  /// Returns whether a pose is known, so that nothing can turn.
  bool isTied() const { return fixed_poses + pose_priors > 0; }
  /// Returns whether nothing in the part is known.
  bool isOpen() const { return !isTied() && places.empty(); }

  bool hasPoses(const PoseGraph<Pose>& graph) const { return first < int(graph.poses.size()); }
};

/// Returns the components in the order of their first vertices.
template <class Pose>
std::vector<Component<Pose>> componentsOf(const PoseGraph<Pose>& graph);

/// Rotations of a part that keep its known places where they are.
template <class Pose>
struct FreeRotation {
  int dimension = 0;  ///< 0: none; 1: about `axis` (in the plane about a point); 3: about a point
  Eigen::Matrix<double, dim<Pose>, 1> axis;  ///< a direction in space with dimension 1
};
template <class Pose>
FreeRotation<Pose> freeRotationOf(const Component<Pose>& component);

}  // namespace slom::app::graph
