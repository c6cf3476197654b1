// All formats, number by number.
#include "graph/graph_command.hpp"
#include "graph/input/information.hpp"
#include "graph/output/g2o.hpp"
#include "graph/simulated_graph.hpp"

namespace slom::app::graph {
namespace {

using testing::parsed;
using testing::simulateGraph;
using testing::unit3;
using testing::unit6;

TEST(GraphRead, Plane) {
  const auto graph =
      parsed<Pose2>("VERTEX_SE2 7 1 2 0.5\nVERTEX_SE2 3 -1 +2e1 -0.5\nEDGE_SE2 7 3 4 5 0.25 1 2 3 4 5 6\n");
  ASSERT_EQ(graph.poses.size(), 2u);
  EXPECT_TRUE(graph.has_vertices);
  EXPECT_EQ(graph.poses[0].id, 7);
  EXPECT_EQ(graph.poses[1].id, 3);
  EXPECT_EQ(graph.poses[1].value.pos, (mtk::vect<2>(-1, 20)));
  EXPECT_EQ(graph.poses[1].value.orient.angle(), -0.5);
  ASSERT_EQ(graph.edges.size(), 1u);
  const auto& edge = graph.edges[0];
  EXPECT_EQ(edge.from, 0);
  EXPECT_EQ(edge.to, 1);
  EXPECT_EQ(edge.line, 3);
  EXPECT_EQ(edge.measured.pos, (mtk::vect<2>(4, 5)));
  EXPECT_EQ(edge.measured.orient.angle(), 0.25);
  Eigen::Matrix3d information;
  information << 1, 2, 3, 2, 4, 5, 3, 5, 6;
  EXPECT_EQ(edge.information, information);
}

TEST(GraphRead, Space) {
  std::string numbers;
  for (int i = 1; i <= 21; ++i) numbers += " " + std::to_string(i);
  const auto graph = parsed<Pose3>(
      "VERTEX_SE3:QUAT 0 1 2 3 0 0 0.6 0.8\nVERTEX_SE3:QUAT 1 0 0 0 0 0 0 2\n"
      "EDGE_SE3:QUAT 0 1 4 5 6 1 0 0 0" +
      numbers + " \r\n");
  ASSERT_EQ(graph.poses.size(), 2u);
  EXPECT_NEAR(graph.poses[0].value.orient.z(), 0.6, 1e-15);
  EXPECT_NEAR(graph.poses[0].value.orient.w(), 0.8, 1e-15);
  EXPECT_EQ(graph.poses[1].value.orient.w(), 1);
  const auto& edge = graph.edges.at(0);
  EXPECT_EQ(edge.measured.pos, (mtk::vect<3>(4, 5, 6)));
  EXPECT_EQ(edge.measured.orient.x(), 1);
  int next = 1;
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j, ++next) {
      EXPECT_EQ(edge.information(i, j), next);
      EXPECT_EQ(edge.information(j, i), next);
    }
  }
}

TEST(GraphRead, ToroInThePlane) {
  const auto graph =
      parsed<Pose2>("VERTEX2 0 1 2 0.5\nVERTEX2 1 0 0 0\nEDGE2 0 1 4 5 0.25 11 12 22 33 13 23\n");
  EXPECT_EQ(graph.poses.at(0).value.pos, (mtk::vect<2>(1, 2)));
  Eigen::Matrix3d information;
  information << 11, 12, 13, 12, 22, 23, 13, 23, 33;
  EXPECT_EQ(graph.edges.at(0).information, information);
  EXPECT_EQ(graph.edges.at(0).measured.orient.angle(), 0.25);
}

TEST(GraphRead, ToroInSpace) {
  // roll a quarter turn about x, then pitch one about y: x -> -z, y -> x, z -> -y
  const auto graph = parsed<Pose3>(
      "VERTEX3 0 1 2 3 1.5707963267948966 1.5707963267948966 0\nVERTEX3 1 0 0 0 0 0 0.3\n"
      "EDGE3 0 1 4 5 6 0.1 0 0" +
      unit6);
  Eigen::Matrix3d R;
  R << 0, 1, 0, 0, 0, -1, -1, 0, 0;
  EXPECT_TRUE(graph.poses.at(0).value.orient.toRotationMatrix().isApprox(R, 1e-12));
  EXPECT_NEAR(graph.poses.at(1).value.orient.z(), std::sin(0.15), 1e-15);
  EXPECT_NEAR(graph.edges.at(0).measured.orient.x(), std::sin(0.05), 1e-15);
  EXPECT_EQ(graph.edges.at(0).information, Eigen::MatrixXd::Identity(6, 6));
}

TEST(GraphRead, LandmarksInThePlane) {
  const auto graph = parsed<Pose2>("VERTEX_SE2 0 0 0 0\nVERTEX_XY 5 1 2\nEDGE_SE2_XY 0 5 3 4 1 2 5\n");
  EXPECT_EQ(graph.landmarks.at(0).value, (mtk::vect<2>(1, 2)));
  const auto& sighting = graph.sightings.at(0);
  EXPECT_EQ(sighting.from, 0);
  EXPECT_EQ(sighting.to, 0);
  EXPECT_EQ(sighting.measured, (mtk::vect<2>(3, 4)));
  EXPECT_EQ(sighting.information, (Eigen::Matrix2d() << 1, 2, 2, 5).finished());
}

TEST(GraphRead, LandmarksInSpace) {
  const auto graph = parsed<Pose3>(
      "PARAMS_SE3OFFSET 0 0 0 0 0 0 0 -1\nVERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_TRACKXYZ 5 1 2 3\n"
      "EDGE_SE3_TRACKXYZ 0 5 0 3 4 5 11 12 13 22 23 33\n");
  EXPECT_EQ(graph.landmarks.at(0).value, (mtk::vect<3>(1, 2, 3)));
  EXPECT_EQ(graph.sightings.at(0).measured, (mtk::vect<3>(3, 4, 5)));
  EXPECT_EQ(graph.sightings.at(0).information,
            (Eigen::Matrix3d() << 11, 12, 13, 12, 22, 23, 13, 23, 33).finished());
}

TEST(GraphRead, NoVertices) {
  const auto graph = parsed<Pose2>("EDGE_SE2 9 2 1 0 0" + unit3 + "EDGE_SE2 2 4 1 0 0" + unit3 +
                                   "EDGE_SE2_XY 4 3 1 0 1 0 1\nFIX 4\n");
  EXPECT_FALSE(graph.has_vertices);
  EXPECT_TRUE(graph.has_fix_lines);
  ASSERT_EQ(graph.poses.size(), 3u);
  EXPECT_EQ(graph.poses[0].id, 2);
  EXPECT_EQ(graph.poses[1].id, 4);
  EXPECT_EQ(graph.poses[2].id, 9);
  EXPECT_TRUE(graph.poses[1].held);
  EXPECT_EQ(graph.edges[0].from, 2);
  EXPECT_EQ(graph.landmarks.at(0).id, 3);
}

TEST(GraphRead, EdgesMayStandBeforeVertices) {
  const auto graph =
      parsed<Pose2>("EDGE_SE2 0 1 1 0 0" + unit3 + "FIX 1\nVERTEX_SE2 1 5 0 0\nVERTEX_SE2 0 4 0 0");
  EXPECT_EQ(graph.edges.at(0).from, 1);
  EXPECT_EQ(graph.edges.at(0).to, 0);
  EXPECT_TRUE(graph.poses.at(0).held);
}

TEST(GraphRead, UnknownTagsAreCountedAndCommentsSkipped) {
  const std::string content = "\xEF\xBB\xBF# a map\n\n  \t\r\nEDGE_SE2 0 1 1 0 0" + unit3 +
                              "ODOM 1 2 3\nVERTEX_CAM 1\n #EDGE_SE2 7\nODOM\n";
  const auto graph = parsed<Pose2>(content);
  EXPECT_EQ(graph.unknown_tags.lines, (std::map<std::string, int>{{"ODOM", 2}, {"VERTEX_CAM", 1}}));
  const testing::TemporaryFolder folder;
  const auto result = testing::runIn(folder, content, {});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("  warning: skipped 2 lines with the unknown tag ODOM\n"
                               "  warning: skipped 1 line with the unknown tag VERTEX_CAM\n"),
            std::string::npos)
      << result.output;
}

TEST(GraphRead, OfManyUnknownTagsFiveAreNamed) {
  std::string content = "EDGE_SE2 0 1 1 0 0" + unit3;
  for (int i = 0; i < 1000; ++i) content += "T" + std::to_string(i) + " 1\n";
  content += "T4 2\n" + std::string(100, 'X') + "\n";
  const testing::TemporaryFolder folder;
  const auto result = testing::runIn(folder, content, {});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  std::string warnings;
  for (int i = 0; i < 5; ++i)
    warnings += "  warning: skipped " + std::string(i == 4 ? "2 lines" : "1 line") +
                " with the unknown tag T" + std::to_string(i) + "\n";
  EXPECT_NE(result.output.find(warnings + "  warning: skipped 996 lines with other unknown tags\n\n"),
            std::string::npos)
      << result.output;
}

TEST(GraphRead, LinesWithoutEnd) {
  testing::expectRefused(std::string((16 << 20) + 1, ' '),
                         "map.g2o:1: the line is longer than 16777216 bytes; this is no pose graph");
  testing::expectRefused("# 1\nEDGE_SE2 0 1" + std::string(17 << 20, '\0'),
                         "map.g2o:2: the line is longer than 16777216 bytes; this is no pose graph");
}

TEST(GraphRead, Devices) {
  EXPECT_EQ(testing::runGraph({"/dev/zero"}).errors,
            "slom: /dev/zero: this is a device; give a file or a pipe\n");
}

TEST(GraphRead, LinesLongerThanTheBuffer) {
  const std::string blanks(3 << 20, ' ');
  const auto graph =
      parsed<Pose2>("EDGE_SE2 0 1 1 0 0" + blanks + unit3 + "#" + blanks + "\nEDGE_SE2 1 2 1 0 0" + unit3);
  EXPECT_EQ(graph.edges.size(), 2u);
  EXPECT_EQ(graph.edges.at(1).line, 3);
}

template <class Pose>
void expectWrittenGraphIsTheSame() {
  const auto graph = simulateGraph<Pose>(9, 0.1, 1);
  const auto again = parsed<Pose>(toG2o(graph));
  ASSERT_EQ(again.poses.size(), graph.poses.size());
  ASSERT_EQ(again.landmarks.size(), graph.landmarks.size());
  ASSERT_EQ(again.edges.size(), graph.edges.size());
  ASSERT_EQ(again.sightings.size(), graph.sightings.size());
  for (std::size_t i = 0; i < graph.poses.size(); ++i) {
    EXPECT_EQ(again.poses[i].id, graph.poses[i].id);
    EXPECT_EQ(again.poses[i].held, graph.poses[i].held);
    EXPECT_LT(mtk::difference(again.poses[i].value, graph.poses[i].value).norm(), 1e-15);
  }
  for (std::size_t i = 0; i < graph.edges.size(); ++i) {
    EXPECT_EQ(again.edges[i].from, graph.edges[i].from);
    EXPECT_EQ(again.edges[i].to, graph.edges[i].to);
    EXPECT_EQ(again.edges[i].information, graph.edges[i].information);
    EXPECT_LT(mtk::difference(again.edges[i].measured, graph.edges[i].measured).norm(), 1e-15);
  }
  for (std::size_t i = 0; i < graph.sightings.size(); ++i) {
    EXPECT_EQ(again.sightings[i].to, graph.sightings[i].to);
    EXPECT_EQ(again.sightings[i].measured, graph.sightings[i].measured);
    EXPECT_EQ(again.sightings[i].information, graph.sightings[i].information);
  }
}
TEST(GraphRead, WhatWasWrittenInThePlane) { expectWrittenGraphIsTheSame<Pose2>(); }
TEST(GraphRead, WhatWasWrittenInSpace) { expectWrittenGraphIsTheSame<Pose3>(); }

TEST(GraphRead, NearestInformation) {
  auto graph = parsed<Pose2>("EDGE_SE2 0 1 1 0 0 1 2 0 1 0 1\nEDGE_SE2 0 1 1 0 0 2 1 0 2 0 1\n");
  const Symmetric<3> good = graph.edges[1].information;
  EXPECT_EQ(checkInformation(graph, true), 1);
  EXPECT_EQ(graph.edges[1].information, good);
  Eigen::Matrix3d nearest;
  nearest << 1.5, 1.5, 0, 1.5, 1.5, 0, 0, 0, 1;
  EXPECT_TRUE(graph.edges[0].information.isApprox(nearest, 1e-11)) << graph.edges[0].information;
  EXPECT_EQ(checkInformation(graph, false), 0);
}

}  // namespace
}  // namespace slom::app::graph
