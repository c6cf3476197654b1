#include "linearize/data.hpp"

#include <random>

namespace slom::bench {

namespace {

/// Random numbers of one data set.
class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  mtk::vect<3> box(double half_width) {
    const double x = uniform(-half_width, half_width), y = uniform(-half_width, half_width);
    return {x, y, uniform(-half_width, half_width)};
  }
  /// Returns a pose turned by up to `angle` about each axis and moved by up to `distance` along it.
  SE3 pose(double angle, double distance) {
    const mtk::SO3<> rotation = mtk::SO3<>::exp(box(angle));
    return {rotation, box(distance)};
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace

BalData simulateBal() {
  constexpr int cameras = 16, views_of_a_point = 4;
  Random random(1);
  BalData data;
  for (int i = 0; i < cameras; ++i) {
    SE3 pose = random.pose(0.4, 1.0);
    pose.pos[2] -= 10;
    data.cameras.emplace_back(
        pose, Vec3{random.uniform(400, 600), random.uniform(-0.1, 0.0), random.uniform(0.0, 0.02)});
  }
  for (int i = 0; i < kMeasurements; ++i) {
    const int point = i / views_of_a_point;
    const int camera = (point + 5 * (i % views_of_a_point)) % cameras;
    if (i % views_of_a_point == 0) data.points.push_back(random.box(2.0));
    const auto r = BalReprojection()(data.cameras[std::size_t(camera)], data.points.back(), mtk::vect<2>());
    data.observations.push_back(
        {camera, point, {r[0] + random.uniform(-2, 2), r[1] + random.uniform(-2, 2)}});
  }
  return data;
}

PoseGraphData simulatePoseGraph() {
  constexpr int poses = kMeasurements / 2;
  Random random(2);
  PoseGraphData data;
  data.poses.emplace_back();
  for (int i = 1; i < poses; ++i) data.poses.push_back(data.poses.back() * random.pose(0.5, 1.0));
  for (int i = 0; i < kMeasurements; ++i) {
    const int a = i / 2, b = (a + (i % 2 == 0 ? 1 : 20)) % poses;
    const SE3 between = data.poses[std::size_t(a)].inverse() * data.poses[std::size_t(b)];
    data.edges.push_back({a, b, between * random.pose(0.1, 0.1)});
  }
  return data;
}

StereoData simulateStereo() {
  constexpr int rows = 8, corners = 64;
  constexpr double square_m = 0.03;
  Random random(3);
  StereoData data;
  data.intrinsics = StereoIntrinsics({533.0, 534.0, 342.0, 234.0, -0.28, 0.05, 0.001, -0.0002, 0.1},
                                     {537.0, 536.0, 326.0, 249.0, -0.29, 0.10, -0.0005, 0.0001, -0.04});
  data.left2right = {mtk::SO3<>::exp(mtk::vect<3>(0.005, 0.004, -0.003)), mtk::vect<3>(-0.08, 0.001, 0.0005)};
  for (int i = 0; i < kMeasurements; ++i) {
    if (i % corners == 0) {
      SE3 board = random.pose(0.4, 0.1);
      board.pos += mtk::vect<3>(-0.1, -0.1, 0.6);
      data.board2left.push_back(board);
    }
    const int corner = i % corners;
    const mtk::vect<3> on_board(square_m * (corner % rows), square_m * (corner / rows), 0.0);
    const auto r = StereoReprojection()(data.intrinsics, data.left2right, data.board2left.back(), on_board,
                                        mtk::vect<4>());
    mtk::vect<4> pixels;
    for (int k = 0; k < 4; ++k) pixels[k] = r[std::size_t(k)] + random.uniform(-2, 2);
    data.corners.push_back({i / corners, on_board, pixels});
  }
  return data;
}

}  // namespace slom::bench
