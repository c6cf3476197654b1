// Maps with known truth.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include <mtk/types/so2.hpp>
#include <mtk/types/so3.hpp>
#include <mtk/types/trafo.hpp>
#include <slom/initialize/pose_graph.hpp>

namespace slom::testing {

using Pose2 = mtk::trafo<mtk::SO2<>>;
using Pose3 = mtk::trafo<mtk::SO3<>>;
template <class Pose>
using Map = initialize::PoseGraph<Pose, mtk::vect<Pose::DIM>>;

template <class V>
V randomTangent(std::mt19937_64& random, double position, double rotation, int dim) {
  std::normal_distribution<double> normal;
  V d;
  for (int i = 0; i < d.size(); ++i) d[i] = normal(random) * (i < dim ? position : rotation);
  return d;
}

/// `count` poses on a ring with random orientations, edges from each to the next two, landmarks that three
/// poses see; the first pose is fixed at the identity. Noise in the units of the map [and rad]; information
/// with weights that differ.
template <class Pose>
Map<Pose> ring(int count, double noise, std::uint64_t seed) {
  constexpr int dim = Pose::DIM;
  using Tangent = Eigen::Matrix<double, Pose::DOF, 1>;
  using Vector = mtk::vect<dim>;
  std::mt19937_64 random(seed);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  Map<Pose> map;
  for (int i = 0; i < count; ++i) {
    Pose pose = mtk::moved(Pose(), randomTangent<Tangent>(random, 0.3, 1, dim));
    pose.pos[0] += 5 * std::cos(2 * M_PI * i / count);
    pose.pos[1] += 5 * std::sin(2 * M_PI * i / count);
    map.addPose(i == 0 ? Pose() : pose, i == 0);
  }
  const auto value = [&](int i) { return map.poses[std::size_t(i)].value; };
  for (int i = 0; i < count; ++i) {
    for (int step = 1; step <= 2; ++step) {
      const int j = (i + step) % count;
      const Pose z = mtk::moved(Pose(value(i).inverse() * value(j)),
                                randomTangent<Tangent>(random, noise, 0.3 * noise, dim));
      map.addEdge(i, j, z, uniform(1, 100) * Eigen::Matrix<double, Pose::DOF, Pose::DOF>::Identity());
    }
  }
  for (int i = 0; i + 2 < count; i += 4) {
    const Vector point = value(i) * randomTangent<Vector>(random, 3, 3, dim);
    const int l = map.addLandmark(point);
    for (int j = i; j <= i + 2; ++j) {
      map.addSighting(j, l, value(j).inverse() * point + randomTangent<Vector>(random, noise, noise, dim),
                      uniform(1, 100) * Eigen::Matrix<double, dim, dim>::Identity());
    }
  }
  return map;
}

/// Returns the same map with meaningless values for all nodes that are not fixed.
template <class M>
M scrambled(M map) {
  std::mt19937_64 random(99);
  using Pose = typename M::Pose;
  for (auto& pose : map.poses) {
    if (!pose.fixed)
      pose.value =
          mtk::moved(Pose(), randomTangent<Eigen::Matrix<double, Pose::DOF, 1>>(random, 20, 1, Pose::DIM));
  }
  for (auto& landmark : map.landmarks) {
    if (!landmark.fixed) landmark.value = randomTangent<mtk::vect<Pose::DIM>>(random, 20, 20, Pose::DIM);
  }
  return map;
}

/// The largest distance between the values of two maps.
template <class M>
double distance(const M& a, const M& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.poses.size(); ++i)
    most = std::max(most, mtk::difference(a.poses[i].value, b.poses[i].value).norm());
  for (std::size_t i = 0; i < a.landmarks.size(); ++i)
    most = std::max(most, (a.landmarks[i].value - b.landmarks[i].value).norm());
  return most;
}

}  // namespace slom::testing
