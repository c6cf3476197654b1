// False loop closures, online. With a bounded loss, they stop pulling when others contradict them.
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include <slom/initialize/growing_map.hpp>
#include <slom/io.hpp>
#include <slom/measurements.hpp>
#include <slom/slom.hpp>

#include "support/paths.hpp"
#include "support/slow_with_sanitizers.hpp"

namespace slom {
namespace {

using Pose = io::Pose2;
using Graph = io::PoseGraph<Pose>;
using Point = mtk::vect<2>;

bool isClosure(const io::Edge<Pose>& edge) { return std::abs(edge.from - edge.to) != 1; }

/// Closures have a loss, odometry has none.
struct RobustClosures {
  io::PoseGraphModel odometry{}, closure{};

  void prepare(Estimator&) const {}
  void insertEdge(Estimator& est, const VarID<Pose>& a, const VarID<Pose>& b, const io::Edge<Pose>& e) const {
    (isClosure(e) ? closure : odometry).insertEdge(est, a, b, e);
  }
  void insertSighting(Estimator&, const VarID<Pose>&, const VarID<Point>&, const io::Edge<Point>&) const {}
};

/// The positions after the graph was fed pose by pose.
std::vector<Point> fed(const Graph& graph, const Loss& loss, const UpdateOptions& options = {}) {
  Estimator est;
  initialize::GrowingMap<Graph, RobustClosures> map(est, graph, {.closure = {loss}});
  for (int p = 0; p < static_cast<int>(graph.poses.size()); ++p) {
    map.add(p);
    const UpdateSummary update = est.update(options);
    EXPECT_LE(update.accepted, update.reconsidered);
    EXPECT_TRUE(options.reconsider || update.reconsidered == 0);
  }
  std::vector<Point> positions;
  for (int p = 0; p < static_cast<int>(graph.poses.size()); ++p) positions.push_back(map.pose(p)->pos);
  return positions;
}

/// Returns the first poses of a graph with false closures. These connect any two poses and are off by up to 2 m and 0.5
/// rad. There are `percent` of them for each 100 true ones.
Graph withFalseClosures(Graph graph, std::size_t poses, int percent, unsigned seed) {
  graph.poses.resize(std::min(poses, graph.poses.size()));
  graph.poses[0].fixed = true;
  const int n = static_cast<int>(graph.poses.size());
  std::erase_if(graph.edges, [n](const auto& edge) { return edge.from >= n || edge.to >= n; });
  const auto like = *std::find_if(graph.edges.begin(), graph.edges.end(), isClosure);
  const auto closures = std::count_if(graph.edges.begin(), graph.edges.end(), isClosure);
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> any(0, n - 1);
  std::uniform_real_distribution<double> off(-1, 1);
  for (long k = 0; k < closures * percent / 100; ++k) {
    io::Edge<Pose> edge = like;
    do {
      edge.from = any(random);
      edge.to = any(random);
    } while (std::abs(edge.from - edge.to) < 2);
    const double x = 2 * off(random), y = 2 * off(random), turn = 0.5 * off(random);
    edge.measured = Pose(Point(x, y), mtk::SO2<>(turn));
    graph.edges.push_back(edge);
  }
  return graph;
}

/// Root mean square of the distances.
double distance(const std::vector<Point>& a, const std::vector<Point>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.size()));
}

Graph read(const std::string& file) {
  return std::get<Graph>(io::readPoseGraph(testing::sharedDataPath("posegraph/" + file)));
}

/// A false closure that fits odometry pulls at first, as it must; later ones show that it is wrong.
TEST(FalseClosures, StopPullingWhenOthersContradictThem) {
  Estimator est;
  const Pose step({1, 0}, mtk::SO2<>(0));
  std::vector<VarID<Pose>> poses{est.insertRV(Pose(), false)};
  const auto drive = [&](const Pose& z) {
    poses.push_back(est.insertRV(*poses.back() * z));
    est.insertMeasurement(RelativePose(), poses[poses.size() - 2], poses.back(), measured(z),
                          StandardDeviation(0.1));
    est.update();
  };
  const auto close = [&](int from, const Point& at) {
    est.insertMeasurement(RelativePose(), poses[std::size_t(from)], poses.back(),
                          measured(Pose(at, mtk::SO2<>(0))), StandardDeviation(0.05), GemanMcClure(3));
    est.update({.reconsider = true});
  };
  for (int i = 0; i < 30; ++i) drive(step);
  const VarID<Pose> pulled = poses.back();
  close(0, Point(30, 3));  // after 30 steps odometry is that uncertain
  EXPECT_GT(pulled->pos.y(), 2.5);
  for (int i = 1; i <= 4; ++i) {
    drive(step);
    close(0, Point(30 + i, 0));
  }
  EXPECT_NEAR(pulled->pos.y(), 0, 0.02);
  EXPECT_NEAR(pulled->pos.x(), 30, 0.02);
}

TEST(FalseClosures, LeaveTheMapOfIntelAsItIs) {
  SLOM_SKIP_WITHOUT_SHARED_DATA("posegraph/intel.g2o");
  SLOM_SKIP_WITH_SANITIZERS();
  const Graph all = read("intel.g2o");
  const std::vector<Point> clean = fed(withFalseClosures(all, 10'000, 0, 0), Loss());
  for (const int percent : {10, 50})
    EXPECT_LT(distance(fed(withFalseClosures(all, 10'000, percent, 11), Tukey(5)), clean), 0.01) << percent;
}

/// Odometry drifts by more than the loss tolerates, so even true closures are refused unless they are tried. (The
/// losses themselves move the map by 0.5 m.)
TEST(FalseClosures, HardlyMoveTheMapOfManhattan) {
  SLOM_SKIP_WITHOUT_SHARED_DATA("posegraph/manhattan.g2o");
  SLOM_SKIP_WITH_SANITIZERS();
  const Graph all = read("manhattan.g2o"), clean = withFalseClosures(all, 1200, 0, 0);
  const Loss loss = GemanMcClure(2);
  const UpdateOptions tries{.reconsider = true};
  const std::vector<Point> best = fed(clean, Loss()), robust = fed(clean, loss, tries);
  EXPECT_LT(distance(robust, best), 0.7);
  EXPECT_GT(distance(fed(clean, loss), best), 3);
  for (const int percent : {10, 50})
    EXPECT_LT(distance(fed(withFalseClosures(all, 1200, percent, 11), loss, tries), robust), 0.05) << percent;
}

}  // namespace
}  // namespace slom
