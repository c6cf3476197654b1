// All formats, number by number.
#include <gtest/gtest.h>

#include <slom/io/g2o.hpp>

#include "io/parsed_graph.hpp"
#include "io/simulated_graph.hpp"
#include "support/message_of.hpp"
#include "support/replaced.hpp"
#include "support/temporary_folder.hpp"

namespace slom::io {
namespace {

using testing::parsed;
using testing::simulateGraph;
using testing::unit3;
using testing::unit6;

TEST(G2o, Plane) {
  const auto graph =
      parsed<Pose2>("VERTEX_SE2 7 1 2 0.5\nVERTEX_SE2 3 -1 +2e1 -0.5\nEDGE_SE2 7 3 4 5 0.25 1 2 3 4 5 6\n");
  ASSERT_EQ(graph.poses.size(), 2u);
  EXPECT_TRUE(graph.has_vertices);
  EXPECT_EQ(graph.poses[0].id, 7u);
  EXPECT_EQ(graph.poses[1].id, 3u);
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

TEST(G2o, Space) {
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

TEST(G2o, ToroInThePlane) {
  const auto graph =
      parsed<Pose2>("VERTEX2 0 1 2 0.5\nVERTEX2 1 0 0 0\nEDGE2 0 1 4 5 0.25 11 12 22 33 13 23\n");
  EXPECT_EQ(graph.poses.at(0).value.pos, (mtk::vect<2>(1, 2)));
  Eigen::Matrix3d information;
  information << 11, 12, 13, 12, 22, 23, 13, 23, 33;
  EXPECT_EQ(graph.edges.at(0).information, information);
  EXPECT_EQ(graph.edges.at(0).measured.orient.angle(), 0.25);
}

TEST(G2o, ToroInSpace) {
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

TEST(G2o, LandmarksInThePlane) {
  const auto graph = parsed<Pose2>("VERTEX_SE2 0 0 0 0\nVERTEX_XY 5 1 2\nEDGE_SE2_XY 0 5 3 4 1 2 5\n");
  EXPECT_EQ(graph.landmarks.at(0).value, (mtk::vect<2>(1, 2)));
  const auto& sighting = graph.sightings.at(0);
  EXPECT_EQ(sighting.from, 0);
  EXPECT_EQ(sighting.to, 0);
  EXPECT_EQ(sighting.measured, (mtk::vect<2>(3, 4)));
  EXPECT_EQ(sighting.information, (Eigen::Matrix2d() << 1, 2, 2, 5).finished());
}

TEST(G2o, LandmarksInSpace) {
  const auto graph = parsed<Pose3>(
      "PARAMS_SE3OFFSET 0 0 0 0 0 0 0 -1\nVERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_TRACKXYZ 5 1 2 3\n"
      "EDGE_SE3_TRACKXYZ 0 5 0 3 4 5 11 12 13 22 23 33\n");
  EXPECT_EQ(graph.landmarks.at(0).value, (mtk::vect<3>(1, 2, 3)));
  EXPECT_EQ(graph.sightings.at(0).measured, (mtk::vect<3>(3, 4, 5)));
  EXPECT_EQ(graph.sightings.at(0).information,
            (Eigen::Matrix3d() << 11, 12, 13, 12, 22, 23, 13, 23, 33).finished());
}

TEST(G2o, NoVertices) {
  const auto graph = parsed<Pose2>("EDGE_SE2 9 2 1 0 0" + unit3 + "EDGE_SE2 2 4 1 0 0" + unit3 +
                                   "EDGE_SE2_XY 4 3 1 0 1 0 1\nFIX 4\n");
  EXPECT_FALSE(graph.has_vertices);
  EXPECT_TRUE(graph.has_fix_lines);
  ASSERT_EQ(graph.poses.size(), 3u);
  EXPECT_EQ(graph.poses[0].id, 2u);
  EXPECT_EQ(graph.poses[1].id, 4u);
  EXPECT_EQ(graph.poses[2].id, 9u);
  EXPECT_TRUE(graph.poses[1].fixed);
  EXPECT_EQ(graph.edges[0].from, 2);
  EXPECT_EQ(graph.landmarks.at(0).id, 3u);
}

TEST(G2o, EdgesMayStandBeforeVertices) {
  const auto graph =
      parsed<Pose2>("EDGE_SE2 0 1 1 0 0" + unit3 + "FIX 1\nVERTEX_SE2 1 5 0 0\nVERTEX_SE2 0 4 0 0");
  EXPECT_EQ(graph.edges.at(0).from, 1);
  EXPECT_EQ(graph.edges.at(0).to, 0);
  EXPECT_TRUE(graph.poses.at(0).fixed);
}

TEST(G2o, LinesLongerThanTheBuffer) {
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
    EXPECT_EQ(again.poses[i].fixed, graph.poses[i].fixed);
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
TEST(G2o, WhatWasWrittenInThePlane) { expectWrittenGraphIsTheSame<Pose2>(); }
TEST(G2o, WhatWasWrittenInSpace) { expectWrittenGraphIsTheSame<Pose3>(); }

/// The error of reading a file with this content, its folder left out.
std::string refusal(const std::string& content) {
  const slom::testing::TemporaryFolder folder;
  slom::testing::writeFile(folder / "map.g2o", content);
  const std::string file = (folder / "map.g2o").string();
  return slom::testing::replaced(slom::testing::messageOf([&] { readPoseGraph(file); }), file, "map.g2o");
}

/// Each with the id that programs can branch on; tests/graph has all texts, as the command shows them.
TEST(G2o, ErrorsHaveIds) {
  EXPECT_EQ(refusal("# nothing\n"),
            "[slom.io.empty-file] map.g2o: the file is empty; a pose graph has a line for each edge");
  EXPECT_EQ(
      refusal("VERTEX_SE2 0 0 0 0\n"),
      "[slom.io.no-edges] map.g2o: the file has no edge; a pose graph has lines EDGE_SE2, EDGE_SE3:QUAT, "
      "EDGE2 or "
      "EDGE3");
  EXPECT_EQ(refusal("EDGE_SE2 0 1 1 0 x" + unit3),
            "[slom.io.bad-line] map.g2o:1: word 5 after EDGE_SE2 is \"x\"; write a finite number there");
  EXPECT_EQ(refusal("VERTEX_SE2 0 0 0 0\nEDGE_SE2 0 1 1 0 0" + unit3),
            "[slom.io.bad-graph] map.g2o:2: there is no vertex 1; add a line for it, or remove this one");
  EXPECT_EQ(slom::testing::messageOf([] { readPoseGraph("/dev/zero"); }),
            "[slom.io.device] /dev/zero: this is a device; give a file or a pipe");
}

TEST(G2o, LinesWithoutEnd) {
  EXPECT_EQ(refusal(std::string((16 << 20) + 1, ' ')),
            "[slom.io.bad-line] map.g2o:1: the line is longer than 16777216 bytes; this is not a pose graph");
  EXPECT_EQ(refusal("# 1\nEDGE_SE2 0 1" + std::string(17 << 20, '\0')),
            "[slom.io.bad-line] map.g2o:2: the line is longer than 16777216 bytes; this is not a pose graph");
}

/// Sensors, bearings and priors are written as they were read, digit by digit.
TEST(G2o, SensorsBearingsAndPriorsStayAsTheyAre) {
  const std::string plane =
      "VERTEX_SE2 0 0 0 0.1\nVERTEX_SE2 1 1 0 0\nVERTEX_XY 2 1 1\nEDGE_SE2 0 1 1 0 0 2 0.1 0 2 0 3\n"
      "EDGE_SE2_XY 0 2 1 1 1 0 1\nEDGE_BEARING_SE2_XY 1 2 0.785 100\nEDGE_PRIOR_SE2 0 0.1 0.2 0.3 1 0.1 0.2 2 0.3 3\n"
      "EDGE_PRIOR_SE2_XY 1 1.1 0.2 4 0.5 5\n";
  EXPECT_EQ(toG2o(parsed<Pose2>(plane)), plane);
  EXPECT_EQ(toG2o(parsed<Pose2>(slom::testing::replaced(plane, "EDGE_PRIOR_SE2 0", "EDGE_SE2_PRIOR 0"))),
            plane);
  const std::string space =
      "PARAMS_SE3OFFSET 3 0.1 0.2 0.3 0.5 0.5 0.5 0.5\nPARAMS_SE3OFFSET 7 0 0 0 0 0 0 1\n"
      "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_TRACKXYZ 2 1 1 1\n"
      "EDGE_SE3_TRACKXYZ 0 2 3 0.7 0.8 0.9 1 0.1 0.2 2 0.3 3\nEDGE_SE3_TRACKXYZ 0 2 7 1.1 1.2 1.3 1 0.1 0.2 2 0.3 3\n"
      "EDGE_SE3_PRIOR 0 3 0.1 0.2 0.3 0 0 0 1" +
      unit6 + "EDGE_SE3_PRIOR 0 7 0.1 0.2 0.3 0 0 0 1" + unit6;
  EXPECT_EQ(toG2o(parsed<Pose3>(space)), space);
}

TEST(G2o, SensorsThatAreThereTwice) {
  const std::string bad = "PARAMS_SE3OFFSET 3 0 0 0 0 0 0 1\nEDGE_SE3:QUAT 0 1 0 0 0 0 0 0 1" + unit6 +
                          "PARAMS_SE3OFFSET 3 1 0 0 0 0 0 1\n";
  EXPECT_NE(slom::testing::messageOf([&] {
              parsed<Pose3>(bad);
            }).find("map.g2o:3: sensor 3 is there already, on line 1; remove one of them"),
            std::string::npos);
}

/// Lines of old systems end by a carriage return.
TEST(G2o, LinesThatEndByACarriageReturn) {
  const std::string text = toG2o(simulateGraph<Pose2>(5, 0.1, 1)),
                    windows = slom::testing::replaced(text, "\n", "\r\n");
  std::string returns = "# a comment\n" + text;
  for (char& c : returns) c = c == '\n' ? '\r' : c;
  EXPECT_EQ(toG2o(parsed<Pose2>(returns)), text);
  EXPECT_EQ(toG2o(parsed<Pose2>(windows)), text);
  const std::string bad = "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\rEDGE_SE2 0 1 x\r";
  EXPECT_NE(slom::testing::messageOf([&] { parsed<Pose2>(bad); }).find("map.g2o:2: "), std::string::npos);
}

/// gtsam's symbols have a character in the upper 8 bits, which may be above 127.
TEST(G2o, IdsGoUpTo64Bits) {
  const std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
  const std::string text =
      "VERTEX_SE2 18374686479671623681 0 0 0\nVERTEX_SE2 18446744073709551615 1 0 0\nFIX 18446744073709551615\n"
      "EDGE_SE2 18374686479671623681 18446744073709551615 1 0 0 1 0 0 1 0 1\n";
  const auto graph = testing::parsed<Pose2>(text);
  EXPECT_EQ(graph.poses[0].id, 18374686479671623681u);
  EXPECT_EQ(graph.poses[1].id, most);
  EXPECT_TRUE(graph.poses[1].fixed);
  EXPECT_EQ(toG2o(graph), text);
}

}  // namespace
}  // namespace slom::io
