// Maps that landmarks at known places tie down, against a dense fit written out without the project's code.
#include "graph/dense_fit.hpp"
#include "graph/graph_command.hpp"

namespace slom::app::graph {
namespace {

using testing::fitted;
using testing::fittedGraph;
using testing::parsed;
using testing::runIn;
using testing::simulateGraph;
using testing::TemporaryFolder;

/// A map with some fixed landmarks and no fixed pose. Its start is off, as a whole and in each pose.
template <class Pose>
PoseGraph<Pose> knownLandmarks(int fixed, std::uint64_t seed, double way) {
  PoseGraph<Pose> graph = simulateGraph<Pose>(12, 0.02, seed);
  graph.poses[0].fixed = false;
  std::mt19937_64 random(seed);
  for (int l = 0; l < fixed; ++l) graph.landmarks[std::size_t(l)].fixed = true;
  const Pose world = io::testing::randomPose<Pose>(random, 10 * way, way);
  for (auto& pose : graph.poses)
    pose.value = world * pose.value * io::testing::randomPose<Pose>(random, 0.3 * way, 0.1 * way);
  for (auto& landmark : graph.landmarks) {
    if (!landmark.fixed) landmark.value = world * landmark.value;
  }
  return graph;
}

/// The fit from a start anywhere has the RSS of the oracle from a start near the truth, and fixed landmarks stay.
template <class Pose>
void expectTheMinimum(int fixed) {
  for (std::uint64_t seed = 1; seed <= (dim<Pose> == 2 ? 2u : 1u); ++seed) {
    const double expected = testing::leastRss(knownLandmarks<Pose>(fixed, seed, 0.02));
    for (const double way : {0.02, 1.0}) {
      const PoseGraph<Pose> start = knownLandmarks<Pose>(fixed, seed, way);
      const std::string content = toG2o(start);
      EXPECT_NEAR(fitted(content)["final_rss"].template get<double>(), expected, 1e-6 * expected)
          << fixed << " fixed, seed " << seed << ", way " << way;
      EXPECT_NEAR(fitted(content, {"--online"})["final_rss"].template get<double>(), expected,
                  1e-6 * expected)
          << fixed << " fixed, seed " << seed << ", way " << way << ", online";
      const auto graph = parsed<Pose>(fittedGraph(content));
      for (std::size_t l = 0; l < graph.landmarks.size(); ++l) {
        EXPECT_EQ(graph.landmarks[l].fixed, start.landmarks[l].fixed);
        if (start.landmarks[l].fixed) {
          EXPECT_EQ(graph.landmarks[l].value, start.landmarks[l].value);
        }
      }
      for (const auto& pose : graph.poses) EXPECT_FALSE(pose.fixed);
    }
  }
}
TEST(GraphFixedLandmarks, OneInThePlane) { expectTheMinimum<Pose2>(1); }
TEST(GraphFixedLandmarks, TwoInThePlane) { expectTheMinimum<Pose2>(2); }
TEST(GraphFixedLandmarks, OneInSpace) { expectTheMinimum<Pose3>(1); }
TEST(GraphFixedLandmarks, TwoInSpace) { expectTheMinimum<Pose3>(2); }
TEST(GraphFixedLandmarks, ThreeInSpace) { expectTheMinimum<Pose3>(3); }

/// One pose sees two landmarks at (1, 1) and (3, 1) as 2.1 apart, each with information 100. At the right rotation, the
/// error 0.05 occurs twice.
const std::string alone =
    "FIX 2 3\nVERTEX_SE2 0 0.1 0 2\nVERTEX_XY 2 1 1\nVERTEX_XY 3 3 1\n"
    "EDGE_SE2_XY 0 2 1 1 100 0 100\nEDGE_SE2_XY 0 3 3.1 1 100 0 100\n";

TEST(GraphFixedLandmarks, ByHand) {
  EXPECT_NEAR(fitted(alone)["final_rss"].get<double>(), 0.5, 1e-9);
  EXPECT_EQ(fitted(alone)["redundancy"], 1);
  const std::string two = testing::replaced(alone, "FIX 2 3\n", "FIX 2 3\nVERTEX_SE2 1 1 0 0\n") +
                          "EDGE_SE2 0 1 1 0 0 100 0 0 100 0 100\nEDGE_SE2_XY 1 2 0 1 100 0 100\n"
                          "EDGE_SE2_XY 1 3 2 1 100 0 100\n";
  EXPECT_NEAR(fitted(two)["final_rss"].get<double>(), 0.604504510, 1e-8);
}

/// Poses that no edges connect find their places by the landmarks, from any start.
TEST(GraphFixedLandmarks, OfPosesWithoutEdges) {
  std::string content = "FIX 100 101 102\nVERTEX_XY 100 1 1\nVERTEX_XY 101 3 1\nVERTEX_XY 102 2 4\n";
  for (int i = 0; i < 5; ++i) {
    content += "VERTEX_SE2 " + std::to_string(i) + " 50 -70 3\n";
    const Pose2 pose(mtk::SO2<>(i), mtk::vect<2>(i, -i));
    for (const auto& [l, point] :
         std::initializer_list<std::pair<int, mtk::vect<2>>>{{100, {1, 1}}, {101, {3, 1}}, {102, {2, 4}}}) {
      const mtk::vect<2> z = pose.inverse() * point;
      char line[200];
      std::snprintf(line, sizeof line, "EDGE_SE2_XY %d %d %.17g %.17g 1 0 1\n", i, l, z[0], z[1]);
      content += line;
    }
  }
  const auto graph = parsed<Pose2>(fittedGraph(content));
  for (int i = 0; i < 5; ++i)
    EXPECT_LT(
        mtk::difference(graph.poses[std::size_t(i)].value, Pose2(mtk::SO2<>(i), mtk::vect<2>(i, -i))).norm(),
        1e-9);
}

std::string whatIsFixed(const std::string& content) {
  const TemporaryFolder folder;
  const auto result = runIn(folder, content, {});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const std::size_t begin = result.output.find("  fixed: ");
  return begin == std::string::npos ? result.output
                                    : result.output.substr(begin, result.output.find('\n', begin) - begin);
}

TEST(GraphFixedLandmarks, WhatTheyLeaveFreeIsHeldAndSaid) {
  EXPECT_EQ(whatIsFixed(alone), "  fixed: 2 landmarks, by lines FIX");
  EXPECT_EQ(whatIsFixed(testing::replaced(alone, "FIX 2 3", "FIX 2")),
            "  fixed: 1 landmark, by lines FIX; and the heading of pose 0, because the map can turn about "
            "landmark 2");
  const std::string coincident = testing::replaced(alone, "VERTEX_XY 3 3 1", "VERTEX_XY 3 1 1");
  EXPECT_EQ(whatIsFixed(coincident),
            "  fixed: 2 landmarks, by lines FIX; and the heading of pose 0, because the map can turn about "
            "landmark 2, landmark 3");
  const auto inSpace = [](const std::string& fix, const std::string& third) {
    return fix +
           "\nVERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_TRACKXYZ 1 0 0 1\nVERTEX_TRACKXYZ 2 1 0 1\nVERTEX_TRACKXYZ 3 " +
           third +
           "\nEDGE_SE3_TRACKXYZ 0 1 0 0 0 1 1 0 0 1 0 1\nEDGE_SE3_TRACKXYZ 0 2 0 1 0 1 1 0 0 1 0 1\nEDGE_SE3_TRACKXYZ 0 3 0 " +
           third + " 1 0 0 1 0 1\n";
  };
  EXPECT_EQ(whatIsFixed(inSpace("FIX 1", "0 1 1")),
            "  fixed: 1 landmark, by lines FIX; and the rotation of pose 0, because the map can turn about "
            "landmark 1");
  EXPECT_EQ(
      whatIsFixed(inSpace("FIX 1 2", "0 1 1")),
      "  fixed: 2 landmarks, by lines FIX; and the rotation of pose 0, because the map can turn about the "
      "line through "
      "landmark 1, landmark 2");
  EXPECT_EQ(whatIsFixed(inSpace("FIX 1 2 3", "0 1 1")), "  fixed: 3 landmarks, by lines FIX");
  EXPECT_EQ(
      whatIsFixed(inSpace("FIX 1 2 3", "-0.3 0 1")),
      "  fixed: 3 landmarks, by lines FIX; and the rotation of pose 0, because the map can turn about the "
      "line through "
      "landmark 1, landmark 2, landmark 3");
}

TEST(GraphFixedLandmarks, WithoutPlaces) {
  testing::expectRefused(
      "EDGE_SE2_XY 0 2 1 1 1 0 1\nEDGE_SE2_XY 0 3 1 2 1 0 1\nFIX 2 3\n",
      "map.g2o: 2 landmarks are fixed, but the file has no vertices that give their places; fix one of them, "
      "or add "
      "vertices");
}

}  // namespace
}  // namespace slom::app::graph
