#include "graph/initialization/components.hpp"

#include <Eigen/Eigenvalues>

#include "graph/initialization/connected_vertices.hpp"

namespace slom::app::graph {

template <class Pose>
std::vector<Component<Pose>> componentsOf(const PoseGraph<Pose>& graph) {
  const int poses = int(graph.poses.size());
  DisjointSets sets = connectedVertices(graph);
  std::vector<Component<Pose>> components;
  std::vector<int> component_of_first(graph.poses.size() + graph.landmarks.size(), -1);
  std::vector<int> component_of(component_of_first.size());
  for (int i = 0; i < int(component_of_first.size()); ++i) {
    const int first = sets.find(i);
    int& number = component_of_first[std::size_t(first)];
    if (number < 0) {
      number = int(components.size());
      components.emplace_back().first = first;
    }
    component_of[std::size_t(i)] = number;
    Component<Pose>& component = components[std::size_t(number)];
    ++component.vertices;
    if (i < poses) {
      component.fixed_poses += graph.poses[std::size_t(i)].fixed ? 1 : 0;
    } else if (const auto& landmark = graph.landmarks[std::size_t(i - poses)]; landmark.fixed) {
      ++component.fixed_landmarks;
      component.places.push_back(landmark.value);
      component.names.push_back("landmark " + std::to_string(landmark.id));
    }
  }
  const auto componentOf = [&](int vertex) -> Component<Pose>& {
    return components[std::size_t(component_of[std::size_t(vertex)])];
  };
  for (const auto& prior : graph.pose_priors) ++componentOf(prior.pose).pose_priors;
  for (const auto& prior : graph.position_priors) {
    Component<Pose>& component = componentOf(prior.pose);
    component.places.push_back(prior.measured);
    component.names.push_back("the position of pose " +
                              std::to_string(graph.poses[std::size_t(prior.pose)].id));
  }
  return components;
}

template <class Pose>
FreeRotation<Pose> freeRotationOf(const Component<Pose>& component) {
  using Matrix = Eigen::Matrix<double, dim<Pose>, dim<Pose>>;
  using Place = typename Component<Pose>::Place;
  constexpr double same = 1e-7;  // relative distance below which places are equal, given rounded squares
  Place centre = Place::Zero();
  double size = 0;
  for (const Place& place : component.places) {
    centre += place / double(component.places.size());
    size = std::max(size, place.cwiseAbs().maxCoeff());
  }
  Matrix spread = Matrix::Zero();
  for (const Place& place : component.places) spread += (place - centre) * (place - centre).transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(spread);  // eigenvalues ascending
  const auto& lengths = eigen.eigenvalues();
  const double widest = std::sqrt(std::max(0.0, lengths[dim<Pose> - 1]));
  FreeRotation<Pose> rotation;
  rotation.axis = eigen.eigenvectors().col(dim<Pose> - 1);
  if (widest <= same * size) {
    rotation.dimension = dof<Pose> - dim<Pose>;
  } else if (dim<Pose> == 3 && std::sqrt(std::max(0.0, lengths[1])) <= same * std::max(widest, size)) {
    rotation.dimension = 1;
  }
  return rotation;
}

template std::vector<Component<Pose2>> componentsOf(const PoseGraph<Pose2>&);
template std::vector<Component<Pose3>> componentsOf(const PoseGraph<Pose3>&);
template FreeRotation<Pose2> freeRotationOf(const Component<Pose2>&);
template FreeRotation<Pose3> freeRotationOf(const Component<Pose3>&);

}  // namespace slom::app::graph
