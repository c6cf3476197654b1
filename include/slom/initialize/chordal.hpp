/// chordal: start values from all edges at once, by two linear least-squares problems.
#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "slom/initialize/linear_relaxation.hpp"
#include "slom/initialize/spanning_tree.hpp"

namespace slom::initialize {

/// Properties of a pose type for chordal relaxation: the dimension of its world, 2 or 3, its rotation matrix and its
/// position, and the entries of the tangent space for position and rotation. This template is for types with members
/// `orient` and `pos`, such as mtk::trafo. Specialise it for other types.
template <class Pose>
struct PoseParts {
  static constexpr int dim = Pose::DIM;
  static constexpr int position_at = 0, position_size = dim;
  static constexpr int rotation_at = dim, rotation_size = Pose::DOF - dim;
  using Matrix = Eigen::Matrix<double, dim, dim, Eigen::DontAlign>;
  using Vector = Eigen::Matrix<double, dim, 1, Eigen::DontAlign>;

  /// Returns the rotation matrix, dim x dim.
  static Matrix rotation(const Pose& pose) { return pose.orient.toRotationMatrix(); }
  /// Returns the position in the world.
  static Vector position(const Pose& pose) { return pose.pos; }
  /// Sets the rotation to an orthonormal matrix.
  static void setRotation(Pose& pose, const Matrix& R) { pose.orient = typename Pose::Rotation(R); }
  /// Sets the position.
  static void setPosition(Pose& pose, const Vector& t) { pose.pos = t; }
};

namespace detail {

template <class Graph>
using PoseOf = std::decay_t<decltype(std::declval<Graph&>().poses.front().value)>;
template <class Graph>
using PointOf = std::decay_t<decltype(std::declval<Graph&>().landmarks.front().value)>;

template <class Graph>
void relaxRotations(Graph& graph, const std::vector<char>& fixed) {
  using Parts = PoseParts<PoseOf<Graph>>;
  using Matrix = typename Parts::Matrix;
  LinearRelaxation transposed(Parts::dim, Parts::dim);
  for (std::size_t p = 0; p < fixed.size(); ++p) {
    const Matrix back = Parts::rotation(graph.poses[p].value).transpose();
    transposed.addBlock(fixed[p] != 0 ? back.data() : nullptr);
  }
  const Matrix zero = Matrix::Zero();
  for (const auto& edge : graph.edges) {
    const double w =
        edge.information.diagonal().template segment<Parts::rotation_size>(Parts::rotation_at).mean();
    const Matrix back = Parts::rotation(edge.measured).transpose();
    transposed.add(w, edge.from, edge.to, back.data(), zero.data());
  }
  if (!transposed.solve()) raiseUndetermined();
  for (std::size_t p = 0; p < fixed.size(); ++p) {
    if (fixed[p] != 0) continue;
    Matrix R = Eigen::Map<const Matrix>(transposed.value(static_cast<int>(p))).transpose();
    nearestRotation(Parts::dim, R.data());
    Parts::setRotation(graph.poses[p].value, R);
  }
}

/// Relaxes the positions. Landmarks are blocks after the poses.
template <class Graph>
void relaxPositions(Graph& graph, const std::vector<char>& fixed) {
  using Parts = PoseParts<PoseOf<Graph>>;
  using Vector = typename Parts::Vector;
  const int poses = static_cast<int>(fixed.size());
  std::vector<char> is_seen(graph.landmarks.size(), 0);
  for (const auto& sighting : graph.sightings) is_seen[static_cast<std::size_t>(sighting.to)] = 1;

  LinearRelaxation positions(1, Parts::dim);
  for (std::size_t p = 0; p < fixed.size(); ++p) {
    const Vector t = Parts::position(graph.poses[p].value);
    positions.addBlock(fixed[p] != 0 ? t.data() : nullptr);
  }
  for (std::size_t l = 0; l < graph.landmarks.size(); ++l) {
    const Vector t = graph.landmarks[l].value;
    positions.addBlock(graph.landmarks[l].fixed || is_seen[l] == 0 ? t.data() : nullptr);
  }
  const double one = 1;
  const auto add = [&](double w, int from, int to, const Vector& seen) {
    const Vector offset = Parts::rotation(graph.poses[static_cast<std::size_t>(from)].value) * seen;
    positions.add(w, from, to, &one, offset.data());
  };
  for (const auto& edge : graph.edges) {
    add(edge.information.diagonal().template segment<Parts::position_size>(Parts::position_at).mean(),
        edge.from, edge.to, Parts::position(edge.measured));
  }
  for (const auto& sighting : graph.sightings)
    add(sighting.information.diagonal().mean(), sighting.from, poses + sighting.to, sighting.measured);
  if (!positions.solve()) raiseUndetermined();

  const auto valueOf = [&](int block) { return Eigen::Map<const Vector>(positions.value(block)); };
  for (std::size_t p = 0; p < fixed.size(); ++p) {
    if (fixed[p] == 0) Parts::setPosition(graph.poses[p].value, valueOf(static_cast<int>(p)));
  }
  for (std::size_t l = 0; l < graph.landmarks.size(); ++l) {
    if (!graph.landmarks[l].fixed) graph.landmarks[l].value = valueOf(poses + static_cast<int>(l));
  }
}

}  // namespace detail

/// Computes first rotations, then positions. The rotations minimise sum w |R_j - R_i Z_ij|_F^2 over matrices R that
/// need not be rotations. This is a linear problem. Then each matrix is replaced by the nearest rotation. The positions
/// of poses and landmarks minimise sum w |t_j - t_i - R_i t_ij|^2. w is the mean of the diagonal of the information.
/// Fixed poses and landmarks keep their values. Throws Unreached, [slom.bad-information], [slom.undetermined-start].
///   source   Carlone, Tron, Daniilidis and Dellaert, "Initialization techniques for 3D SLAM: a survey on rotation
///            estimation and its use in pose graph optimization", ICRA 2015, section III.B
template <class Graph>
void chordal(Graph& graph) {
  const std::vector<char> fixed = detail::fixedPoses(graph);
  (void)spanningTree(fixed, detail::edgesOf(graph));  // throws if a pose is not reached
  detail::relaxRotations(graph, fixed);
  detail::relaxPositions(graph, fixed);
}

}  // namespace slom::initialize
