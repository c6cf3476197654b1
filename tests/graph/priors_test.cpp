// Priors, bearings and sensors of g2o's files, against a dense fit.
#include "graph/dense_fit.hpp"
#include "graph/graph_command.hpp"

namespace slom::app::graph {
namespace {

using testing::fitted;
using testing::fittedGraph;
using testing::Json;
using testing::parsed;
using testing::randomVector;
using testing::runIn;
using testing::simulateGraph;
using testing::TemporaryFolder;
using testing::unit3;
using testing::unit6;

/// A map without fixed nodes, but with priors of some poses. In space it has priors of sensors and sightings by
/// sensors, in the plane bearings and priors of positions. `priors` is the number of known whole poses.
template <class Pose>
PoseGraph<Pose> withPriors(int priors, int positions, std::uint64_t seed) {
  PoseGraph<Pose> graph = simulateGraph<Pose>(9, 0.02, seed);
  std::mt19937_64 random(seed);
  graph.poses[0].fixed = false;
  if constexpr (dim<Pose> == 3) {
    graph.sensors.push_back({3, io::testing::randomPose<Pose>(random, 0.3, 1), 0});
    graph.sensors.push_back({8, Pose(), 0});
    for (std::size_t i = 0; i < graph.sightings.size();
         i += 3) {  // every third sighting is that of the first sensor
      auto sensed = graph.sightings[i];
      sensed.from = 0;
      sensed.measured = graph.sensors[0].offset.inverse() * sensed.measured;
      graph.as_sensed.emplace(i, sensed);
    }
  }
  for (int i = 0; i < priors; ++i) {
    io::PosePrior<Pose> prior;
    prior.pose = 2 * i;
    if (dim<Pose> == 3) prior.sensor = i % 2;
    prior.measured = graph.poses[std::size_t(2 * i)].value * graph.offsetOf(prior) *
                     io::testing::randomPose<Pose>(random, 0.05, 0.02);
    prior.information = io::testing::randomInformation<dof<Pose>>(random, 100);
    graph.pose_priors.push_back(prior);
  }
  for (int i = 0; i < positions; ++i) {
    io::PositionPrior<Pose> prior;
    prior.pose = 3 * i;
    prior.measured = graph.poses[std::size_t(3 * i)].value.pos + randomVector<dim<Pose>>(random, 0.05);
    prior.information = io::testing::randomInformation<dim<Pose>>(random, 100);
    graph.position_priors.push_back(prior);
  }
  if constexpr (dim<Pose> == 2) {
    for (const auto& sighting : std::vector(graph.sightings)) {
      const auto seen = sighting.measured;
      io::Edge<mtk::SO2<>> bearing;
      bearing.from = sighting.from;
      bearing.to = sighting.to;
      bearing.measured = mtk::SO2<>(std::atan2(seen[1], seen[0]) + 0.02);
      bearing.information(0, 0) = 400;
      graph.bearings.push_back(bearing);
    }
    graph.landmarks.push_back({5000, graph.landmarks[0].value});  // known by bearings alone
    for (int i = 0; i < 3; ++i) {
      io::Edge<mtk::SO2<>> bearing = graph.bearings[std::size_t(i)];
      bearing.to = int(graph.landmarks.size()) - 1;
      graph.bearings.push_back(bearing);
    }
  }
  return graph;
}

template <class Pose>
void expectTheMinimum(int priors, int positions, bool quaternion = false) {
  for (std::uint64_t seed = 1; seed <= (dim<Pose> == 2 ? 3u : 2u); ++seed) {
    const auto start = parsed<Pose>(toG2o(withPriors<Pose>(priors, positions, seed)));
    const double expected = testing::leastRss(start, quaternion);
    for (const bool is_scrambled : {false, true}) {
      const std::string content = toG2o(is_scrambled ? io::testing::scrambled(start) : start);
      const testing::Json json = fitted(content, {"--rotation-error", quaternion ? "quaternion" : "vector"});
      EXPECT_NEAR(json["final_rss"].get<double>(), expected, 1e-6 * expected)
          << priors << " and " << positions << " priors, seed " << seed << ", scrambled " << is_scrambled;
    }
  }
}
TEST(GraphPriors, OfPosesInThePlane) { expectTheMinimum<Pose2>(3, 0); }
TEST(GraphPriors, OfOnePoseInThePlane) { expectTheMinimum<Pose2>(1, 0); }
TEST(GraphPriors, OfPositionsInThePlane) { expectTheMinimum<Pose2>(0, 3); }
TEST(GraphPriors, OfOnePositionInThePlane) { expectTheMinimum<Pose2>(0, 1); }
TEST(GraphPriors, OfBothInThePlane) { expectTheMinimum<Pose2>(2, 2); }
TEST(GraphPriors, OfSensorsInSpace) { expectTheMinimum<Pose3>(3, 0); }
TEST(GraphPriors, OfSensorsInSpaceByQuaternions) { expectTheMinimum<Pose3>(2, 0, true); }

TEST(GraphPriors, ByHand) {
  // Poses 1 apart are measured at x = 5 and 7, all with information 100. They are at 5.5 and 6.5 minus 1/6 of the
  // misfit of 1 each; there are 3 errors of 1/3.
  const std::string content =
      "EDGE_SE2_PRIOR 1 5 6 0 100 0 0 100 0 100\nEDGE_PRIOR_SE2 2 7 6 0 100 0 0 100 0 100\n"
      "EDGE_SE2 1 2 1 0 0 100 0 0 100 0 100\n";
  EXPECT_NEAR(fitted(content)["final_rss"].get<double>(), 100.0 / 3, 1e-9);
  const auto graph = parsed<Pose2>(fittedGraph(content));
  EXPECT_NEAR(graph.poses[0].value.pos[0], 5 + 1.0 / 3, 1e-9);
  EXPECT_NEAR(graph.poses[1].value.pos[0], 7 - 1.0 / 3, 1e-9);
  EXPECT_NEAR(graph.poses[1].value.pos[1], 6, 1e-9);
}

/// A sensor is 1 in front of the robot and turned by a quarter about z. It is seen at (5, 6, 7) with that rotation, so
/// the robot is at (4, 6, 7).
TEST(GraphPriors, TheSensorSitsOnTheRobot) {
  const std::string content =
      "PARAMS_SE3OFFSET 4 1 0 0 0 0 0.70710678118654752 0.70710678118654752\n"
      "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_TRACKXYZ 1 0 0 0\n"
      "EDGE_SE3_PRIOR 0 4 5 6 7 0 0 0.70710678118654752 0.70710678118654752" +
      unit6 + "EDGE_SE3_TRACKXYZ 0 1 4 1 2 3 1 0 0 1 0 1\n";
  const auto graph = parsed<Pose3>(fittedGraph(content));
  EXPECT_LT((graph.poses[0].value.pos - mtk::vect<3>(4, 6, 7)).norm(), 1e-9);
  EXPECT_LT((graph.landmarks[0].value - mtk::vect<3>(5 - 2, 6 + 1, 7 + 3)).norm(), 1e-9);
}

TEST(GraphPriors, OfPositionsAreAGroupOfTheirOwn) {
  const Json json = fitted("EDGE_SE2 1 2 1 0 0" + unit3 + "EDGE_SE2_PRIOR 1 5 6 0" + unit3 +
                           "EDGE_PRIOR_SE2_XY 2 6 6 1 0 1\n");
  ASSERT_EQ(json["groups"].size(), 3u);
  EXPECT_EQ(json["groups"][1]["name"], "prior");
  EXPECT_EQ(json["groups"][2]["name"], "position prior");
}

TEST(GraphPriors, ASensorWithoutAPlaceIsNamed) {
  const std::string vertex = "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n",
                    place = "PARAMS_SE3OFFSET 4 1 0 0 0 0 0 1\n", rest = " 5 6 7 0 0 0 1" + unit6,
                    sensor4 = "EDGE_SE3_PRIOR 0 4" + rest, sensor9 = "EDGE_SE3_PRIOR 0 9" + rest;
  EXPECT_EQ(fitted(place + vertex + sensor4)["warnings"], Json::array());
  EXPECT_EQ(
      fitted(vertex + sensor4)["warnings"],
      Json::array(
          {"there is no line PARAMS_SE3OFFSET 4: this sensor is taken at the origin of the robot; add the "
           "line if it is elsewhere"}));
  EXPECT_EQ(
      fitted(vertex + sensor9 + sensor4 + sensor4)["warnings"],
      Json::array(
          {"there are no lines PARAMS_SE3OFFSET 4 and 9: these sensors are taken at the origin of the robot; "
           "add the lines if they are elsewhere"}));
  const TemporaryFolder folder;
  const std::string said = runIn(folder, vertex + sensor4, {}).output;
  EXPECT_NE(said.find("  warning: there is no line PARAMS_SE3OFFSET 4: "), std::string::npos) << said;
}

TEST(GraphPriors, AreSaid) {
  const TemporaryFolder folder;
  const std::string edges = "EDGE_SE2 1 2 1 0 0" + unit3;
  const auto output = [&](const std::string& content, const std::vector<std::string>& options = {}) {
    const auto result = runIn(folder, content, options);
    return result.output + result.errors;
  };
  EXPECT_TRUE(output(edges + "EDGE_SE2_PRIOR 1 5 6 0" + unit3)
                  .starts_with("graph in the plane, map.g2o\n  2 poses, 1 edge\n  1 prior\n"
                               "  fixed: nothing, because priors place the map\n"));
  EXPECT_NE(
      output(edges + "EDGE_PRIOR_SE2_XY 1 5 6 1 0 1\n")
          .find("  fixed: nothing, because priors place the map; and the heading of pose 1, because the map "
                "can turn about "
                "the position of pose 1\n"),
      std::string::npos);
  EXPECT_EQ(
      output(edges + "EDGE_PRIOR_SE2_XY 1 5 6 1 0 1\n", {"--online"}),
      "slom: --online: map.g2o has bearings or priors, which cannot be fed pose by pose; leave the option out\n");
  const std::string bearings =
      "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nVERTEX_XY 2 1 1\nEDGE_SE2 0 1 1 0 0 100 0 0 100 0 100\n"
      "EDGE_BEARING_SE2_XY 0 2 0.785 100\nEDGE_BEARING_SE2_XY 1 2 1.5708 100\n";
  EXPECT_NEAR(fitted(bearings)["final_rss"].get<double>(), 0, 1e-12);
  EXPECT_NE(output(bearings).find("  1 landmark, 0 sightings\n  2 bearings\n"), std::string::npos)
      << output(bearings);
}

}  // namespace
}  // namespace slom::app::graph
