// The code of docs/graph.md: reading, fitting and writing a file of g2o.
#include <fstream>

#include <gtest/gtest.h>

#include <slom/initialize.hpp>
#include <slom/io.hpp>

#include "io/parsed_graph.hpp"
#include "support/paths.hpp"

namespace {

TEST(IoPage, ReadsFitsAndWritesAGraph) {
  const slom::testing::TemporaryFolder folder;
  const std::string file = slom::testing::sourcePath("data/simulated_pose_graph/town.g2o").string();
  const std::string fitted = (folder / "fitted.g2o").string();
  slom::io::AnyPoseGraph any = slom::io::readPoseGraph(file);
  auto& graph = std::get<slom::io::PoseGraph<slom::io::Pose2>>(any);  // a graph in the plane
  if (!graph.has_fix_lines) graph.poses[0].fixed = true;
  if (!graph.has_vertices) slom::initialize::alongSpanningTree(graph);

  slom::Estimator est;
  const auto ids = slom::io::insert(est, graph);
  const slom::Summary summary = est.optimize();
  ids.writeTo(graph);
  std::ofstream(fitted) << slom::io::toG2o(graph);

  EXPECT_TRUE(summary.converged);
  const auto again = slom::io::testing::parsed<slom::io::Pose2>(slom::testing::readFile(fitted));
  EXPECT_EQ(slom::io::toG2o(again), slom::io::toG2o(graph));
  EXPECT_NEAR(slom::initialize::rssOf(again, slom::io::PoseGraphModel()), summary.final_rss,
              1e-9 * summary.final_rss);
}

TEST(IoPage, ReadsAndFitsAScene) {
  const std::string file = slom::testing::sourcePath("data/simulated_bundle/scene.txt").string();
  slom::io::Scene scene = slom::io::readScene(file);
  slom::Estimator est;
  est.changeAlgorithm(slom::LevenbergMarquardt(1e-4, 0.1));
  const slom::io::SceneVariables ids = slom::io::insert(est, scene);
  const slom::Summary summary = est.optimize();
  ids.writeTo(scene);

  EXPECT_TRUE(summary.converged);
  EXPECT_NEAR(scene.sumOfSquares(), summary.final_rss, 1e-9 * summary.final_rss);
  EXPECT_LT(scene.rms(), 1);
}

}  // namespace
