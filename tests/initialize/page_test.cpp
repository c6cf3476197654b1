// The code that docs/initialize.md shows.
#include <gtest/gtest.h>

#include <slom/initialize.hpp>

namespace {

using Pose = mtk::trafo<mtk::SO2<>>;
using Point = mtk::vect<2>;

/// A walk round a square with a step that is too long, and a post in the middle that two corners see.
TEST(InitializePage, StartsAWalkRoundASquare) {
  const Pose forward(mtk::vect<2>(1.02, 0)), left(mtk::SO2<>(M_PI / 2), mtk::vect<2>(1.0, 0));
  const Eigen::Vector3d sigma(0.02, 0.02, 0.01);
  const Eigen::Matrix3d information = sigma.cwiseAbs2().cwiseInverse().asDiagonal();

  slom::initialize::PoseGraph<Pose, Point> graph;
  int last = graph.addPose(Pose(), true);  // fixed: where the map begins
  for (int step = 1; step < 8; ++step) {
    const int next = graph.addPose();
    graph.addEdge(last, next, step % 2 == 0 ? left : forward, information);
    last = next;
  }
  graph.addEdge(last, 0, left, information);
  const int post = graph.addLandmark();
  graph.addSighting(0, post, Point(1, 1), 100 * Eigen::Matrix2d::Identity());
  graph.addSighting(4, post, Point(1, 1), 100 * Eigen::Matrix2d::Identity());

  const slom::initialize::Choice choice = slom::initialize::findBestStart(graph);

  slom::Estimator est;
  std::vector<slom::VarID<Pose>> poses;
  for (const auto& pose : graph.poses) poses.push_back(est.insertRV(pose.value, !pose.fixed));
  const auto landmark = est.insertRV(graph.landmarks[std::size_t(post)].value, "post");
  for (const auto& edge : graph.edges) {
    est.insertMeasurement(slom::RelativePose(), poses[std::size_t(edge.from)], poses[std::size_t(edge.to)],
                          slom::measured(edge.measured), slom::InvCovariance(edge.information));
  }
  for (const auto& sighting : graph.sightings) {
    est.insertMeasurement(slom::Landmark(), poses[std::size_t(sighting.from)], landmark,
                          slom::measured(sighting.measured), slom::InvCovariance(sighting.information));
  }
  const slom::Summary summary = est.optimize();
  EXPECT_TRUE(summary.converged);
  EXPECT_EQ(choice.costs.size(), 4u);
  EXPECT_LT(summary.initial_rss - summary.final_rss, 1e-3 * summary.initial_rss);
  EXPECT_LT(((*landmark) - Point(1, 1)).norm(), 0.05);
}

// A pose of a user's own that has other members than `orient` and `pos`.
struct Planar {
  mtk::vect<2> where;
  double heading = 0;  // [rad]

  Planar inverse() const {
    const mtk::SO2<> back(-heading);
    return {-(back * where), -heading};
  }
  friend Planar operator*(const Planar& a, const Planar& b) {
    return {a.where + mtk::SO2<>(a.heading) * b.where, mtk::SO2<>(a.heading + b.heading).angle()};
  }
  friend mtk::vect<2> operator*(const Planar& a, const mtk::vect<2>& p) {
    return a.where + mtk::SO2<>(a.heading) * p;
  }
};

}  // namespace

template <>
struct slom::initialize::PoseParts<Planar> {
  static constexpr int dim = 2;
  static constexpr int position_at = 0, position_size = 2;  // in the tangent space
  static constexpr int rotation_at = 2, rotation_size = 1;
  using Matrix = Eigen::Matrix<double, 2, 2, Eigen::DontAlign>;
  using Vector = Eigen::Matrix<double, 2, 1, Eigen::DontAlign>;

  static Matrix rotation(const Planar& pose) { return mtk::SO2<>(pose.heading).toRotationMatrix(); }
  static Vector position(const Planar& pose) { return pose.where; }
  static void setRotation(Planar& pose, const Matrix& R) { pose.heading = mtk::SO2<>(R).angle(); }
  static void setPosition(Planar& pose, const Vector& t) { pose.where = t; }
};

namespace {

TEST(InitializePage, TakesPosesOfAUsersOwn) {
  slom::initialize::PoseGraph<Planar, Point> graph;
  graph.addPose(Planar(), true);
  for (int i = 1; i < 12; ++i) {
    graph.addPose();
    graph.addEdge(i - 1, i, {{1, 0}, 0.5});
  }
  const auto start = graph;
  slom::initialize::alongOdometry(graph);
  const auto truth = graph;
  graph.addEdge(0, 11, graph.poses[11].value);
  graph.addLandmark();
  graph.addSighting(3, 0, {1, 2});
  for (const auto method : {slom::initialize::Start::chordal, slom::initialize::Start::build_up}) {
    auto here = graph;
    here.poses = start.poses;
    slom::initialize::findStart(here, method);
    for (std::size_t i = 0; i < truth.poses.size(); ++i) {
      EXPECT_LT((here.poses[i].value.where - truth.poses[i].value.where).norm(), 1e-9);
      EXPECT_NEAR(mtk::SO2<>(here.poses[i].value.heading - truth.poses[i].value.heading).angle(), 0, 1e-9);
    }
    EXPECT_LT((here.landmarks[0].value - truth.poses[3].value * Point(1, 2)).norm(), 1e-9);
  }
}

}  // namespace
