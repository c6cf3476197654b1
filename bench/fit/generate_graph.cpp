#include "fit/generate_graph.hpp"

#include <array>
#include <cmath>
#include <cstdint>

#include <mtk/testing/random.hpp>

namespace slom::bench {

namespace {

using io::dim;
using io::dof;
using mtk::testing::Random;

constexpr double kEdgeMetres = 0.05, kEdgeRadians = 0.02;
constexpr double kStartMetres = 0.2, kStartRadians = 0.05;

template <int N>
mtk::vect<N> normalVector(Random& random, double sigma) {
  mtk::vect<N> v;
  for (int i = 0; i < N; ++i) v[i] = sigma * random.normal();
  return v;
}

mtk::SO2<> rotation(const mtk::vect<1>& v) { return mtk::SO2<>(v[0]); }
mtk::SO3<> rotation(const mtk::vect<3>& v) { return mtk::SO3<>::exp(v); }

template <class Pose>
Pose normalPose(Random& random, double metres, double radians) {
  const mtk::vect<dim<Pose>> position = normalVector<dim<Pose>>(random, metres);
  return {rotation(normalVector<dof<Pose> - dim<Pose>>(random, radians)), position};
}

}  // namespace

template <class Pose>
io::PoseGraph<Pose> generateLattice(int size, int dimensions) {
  Random random(1, static_cast<std::uint32_t>(dimensions));
  const int side = static_cast<int>(std::lround(std::pow(size, 1.0 / dimensions)));
  const int layers = dimensions == 3 ? side : 1;
  const std::array<int, 3> extent{side, side, layers}, stride{1, side, side * side};
  const int count = side * side * layers;
  std::vector<Pose> truth;
  truth.reserve(static_cast<std::size_t>(count));
  io::PoseGraph<Pose> graph;
  graph.has_vertices = true;
  for (int i = 0; i < count; ++i) {
    Pose pose = normalPose<Pose>(random, 0, 1);
    for (int axis = 0; axis < std::min(dimensions, dim<Pose>); ++axis) {
      pose.pos[axis] = i / stride[static_cast<std::size_t>(axis)] % extent[static_cast<std::size_t>(axis)];
    }
    truth.push_back(pose);
    const Pose start = i == 0 ? pose : Pose(pose * normalPose<Pose>(random, kStartMetres, kStartRadians));
    graph.poses.push_back({std::uint64_t(i), start, 0, i == 0});
  }
  Eigen::Matrix<double, dof<Pose>, 1> weight;
  weight.setConstant(1 / (kEdgeRadians * kEdgeRadians));
  weight.template head<dim<Pose>>().setConstant(1 / (kEdgeMetres * kEdgeMetres));
  for (int i = 0; i < count; ++i) {
    for (std::size_t axis = 0; axis < static_cast<std::size_t>(dimensions); ++axis) {
      if (i / stride[axis] % extent[axis] == extent[axis] - 1) continue;
      const int j = i + stride[axis];
      const Pose relative = truth[static_cast<std::size_t>(i)].inverse() * truth[static_cast<std::size_t>(j)];
      graph.edges.push_back({i, j, 0, Pose(relative * normalPose<Pose>(random, kEdgeMetres, kEdgeRadians)),
                             io::Symmetric<dof<Pose>>(weight.asDiagonal())});
    }
  }
  return graph;
}

template io::PoseGraph<io::Pose2> generateLattice(int, int);
template io::PoseGraph<io::Pose3> generateLattice(int, int);

}  // namespace slom::bench
