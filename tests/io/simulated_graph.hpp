// A pose graph with known truth.
#pragma once

#include <random>

#include <slom/io/pose_graph.hpp>

namespace slom::io::testing {

inline mtk::SO2<> rotation(mtk::vect<1> v) { return mtk::SO2<>(v[0]); }
inline mtk::SO3<> rotation(const mtk::vect<3>& v) { return mtk::SO3<>::exp(v); }

template <int N>
mtk::vect<N> randomVector(std::mt19937_64& random, double sigma) {
  std::normal_distribution<double> normal;
  mtk::vect<N> v;
  for (int i = 0; i < N; ++i) v[i] = sigma * normal(random);
  return v;
}

template <class Pose>
Pose randomPose(std::mt19937_64& random, double sigma_position, double sigma_rotation) {
  const mtk::vect<dim<Pose>> position = randomVector<dim<Pose>>(random, sigma_position);
  return {rotation(randomVector<dof<Pose> - dim<Pose>>(random, sigma_rotation)), position};
}

/// Symmetric, with eigenvalues between about 1 and `largest`, and nothing zero.
template <int N>
Symmetric<N> randomInformation(std::mt19937_64& random, double largest) {
  Eigen::Matrix<double, N, N> A;
  for (int i = 0; i < N; ++i) A.col(i) = randomVector<N>(random, std::sqrt(largest / N));
  const Eigen::Matrix<double, N, N> product = A * A.transpose();
  return (product + product.transpose()) / 2 + Eigen::Matrix<double, N, N>::Identity();
}

/// `count` poses all around, edges from each to the next two, and landmarks that three poses see. `noise` is
/// in standard deviations.
template <class Pose>
PoseGraph<Pose> simulateGraph(int count, double noise, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  PoseGraph<Pose> graph;
  graph.has_vertices = true;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * M_PI * i / count;
    Pose pose = randomPose<Pose>(random, 0.3, 1);
    pose.pos[0] += 5 * std::cos(angle);
    pose.pos[1] += 5 * std::sin(angle);
    if (i == 0) pose = Pose();
    graph.poses.push_back({std::uint64_t(10 + i), pose, 0, i == 0});
  }
  const auto value = [&](int i) { return graph.poses[std::size_t(i)].value; };
  for (int i = 0; i < count; ++i) {
    for (int step = 1; step <= 2; ++step) {
      const int j = (i + step) % count;
      const Pose error = randomPose<Pose>(random, noise, 0.3 * noise);
      graph.edges.push_back(
          {i, j, 0, value(i).inverse() * value(j) * error, randomInformation<dof<Pose>>(random, 100)});
    }
  }
  for (int i = 0; i + 2 < count; i += 4) {
    const Point<Pose> point = value(i) * Point<Pose>(randomVector<dim<Pose>>(random, 3));
    graph.landmarks.push_back({std::uint64_t(1000 + i), point});
    for (int j = i; j <= i + 2; ++j) {
      graph.sightings.push_back({j, int(graph.landmarks.size()) - 1, 0,
                                 value(j).inverse() * point + randomVector<dim<Pose>>(random, noise),
                                 randomInformation<dim<Pose>>(random, 100)});
    }
  }
  return graph;
}

/// The same graph with values that mean nothing.
template <class Pose>
PoseGraph<Pose> scrambled(PoseGraph<Pose> graph) {
  std::mt19937_64 random(99);
  for (auto& pose : graph.poses) {
    if (!pose.fixed) pose.value = randomPose<Pose>(random, 20, 2);
  }
  for (auto& landmark : graph.landmarks) landmark.value = randomVector<dim<Pose>>(random, 20);
  return graph;
}

}  // namespace slom::io::testing
