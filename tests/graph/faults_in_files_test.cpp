// Every mistake in a file, word for word.
#include "graph/graph_command.hpp"

namespace slom::app::graph {
namespace {

using testing::expectRefused;
using testing::unit3;
using testing::unit6;

const std::string vertices = "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\n";
const std::string edge = "EDGE_SE2 0 1 1 0 0" + unit3;

TEST(GraphFaults, MissingFile) {
  const auto result = testing::runGraph({"no/such/map.g2o"});
  EXPECT_EQ(result.errors,
            "slom: no/such/map.g2o: cannot be read (No such file or directory); check the path\n");
  EXPECT_EQ(result.exit_code, 2);
}
TEST(GraphFaults, Folder) {
  const testing::TemporaryFolder folder;
  const auto result = testing::runGraph({folder.path().string()});
  EXPECT_EQ(result.errors,
            "slom: " + folder.path().string() + ": cannot be read (Is a directory); check the path\n");
}
TEST(GraphFaults, EmptyFile) {
  const std::string sentence = "map.g2o: the file is empty; a pose graph has a line for each edge";
  expectRefused("", sentence);
  expectRefused("\n# nothing but this\n  \r\n", sentence);
}
TEST(GraphFaults, NoEdges) {
  const std::string sentence =
      "map.g2o: the file has no edge; a pose graph has lines EDGE_SE2, EDGE_SE3:QUAT, EDGE2 or EDGE3";
  expectRefused(vertices, sentence);
  expectRefused(
      "ODOMETRY 1 0 0\nLANDMARK 3 4\nODOMETRY 1 0 0\n",
      "map.g2o: the file has no edge, its lines begin with LANDMARK, ODOMETRY; a pose graph has lines "
      "EDGE_SE2, EDGE_SE3:QUAT, EDGE2 or EDGE3");
}
TEST(GraphFaults, WrongNumberOfWords) {
  expectRefused(vertices + "EDGE_SE2 0 1 1 0 0 1 0 0 1 0\n",
                "map.g2o:3: there are 10 words after EDGE_SE2 instead of 11; write \"EDGE_SE2 i j x y theta "
                "I11 I12 I13 "
                "I22 I23 I33\"");
  expectRefused(vertices + "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1 7\n",
                "map.g2o:3: there are 12 words after EDGE_SE2 instead of 11; write \"EDGE_SE2 i j x y theta "
                "I11 I12 I13 "
                "I22 I23 I33\"");
  expectRefused(
      "VERTEX_SE2 0 0 0\n" + edge,
      "map.g2o:1: there are 3 words after VERTEX_SE2 instead of 4; write \"VERTEX_SE2 i x y theta\"");
  expectRefused("EDGE_SE2",
                "map.g2o:1: there are 0 words after EDGE_SE2 instead of 11; write \"EDGE_SE2 i j x y theta "
                "I11 I12 I13 I22 I23 I33\"");
  expectRefused("EDGE_SE3:QUAT 0 1 0 0 0 0 0 0 1",
                "map.g2o:1: there are 9 words after EDGE_SE3:QUAT instead of 30; write \"EDGE_SE3:QUAT i j "
                "x y z qx qy qz "
                "qw I11 I12 ... I66\"");
  expectRefused(edge + "FIX\n", "map.g2o:2: there are 0 words after FIX instead of 1; write \"FIX i\"");
}
TEST(GraphFaults, NotANumber) {
  expectRefused(vertices + "EDGE_SE2 0 1 1 zero 0" + unit3,
                "map.g2o:3: word 4 after EDGE_SE2 is \"zero\"; write a finite number there");
  for (const std::string text : {"nan", "inf", "-inf", "1e999", "1.5x", "--1", "+-1", "0x10", "1,5"}) {
    expectRefused("VERTEX_SE2 0 0 0 " + text + "\n" + edge,
                  "map.g2o:1: word 4 after VERTEX_SE2 is \"" + text + "\"; write a finite number there");
  }
  const std::string endless(100, '7');
  expectRefused("VERTEX_SE2 0 0 0 x" + endless + "\n" + edge, "map.g2o:1: word 4 after VERTEX_SE2 is \"x" +
                                                                  endless.substr(0, 36) +
                                                                  "...\"; write a finite number there");
}
TEST(GraphFaults, Ids) {
  for (const std::string id : {"-1", "1.5", "a", "18446744073709551616"}) {
    expectRefused("VERTEX_SE2 " + id + " 0 0 0\n" + edge,
                  "map.g2o:1: the id \"" + id +
                      "\" of VERTEX_SE2 is not a whole number from 0 to 2^64 - 1; correct it");
  }
  expectRefused(vertices + "EDGE_SE2 0 -7 1 0 0" + unit3,
                "map.g2o:3: the id \"-7\" of EDGE_SE2 is not a whole number from 0 to 2^64 - 1; correct it");
}
TEST(GraphFaults, UnknownVertices) {
  expectRefused(vertices + "EDGE_SE2 0 2 1 0 0" + unit3,
                "map.g2o:3: there is no vertex 2; add a line for it, or remove this one");
  expectRefused(edge + "FIX 5\n", "map.g2o:2: there is no vertex 5; add a line for it, or remove this one");
}
TEST(GraphFaults, DuplicateVertex) {
  expectRefused(vertices + "\n\nVERTEX_SE2 1 1 0 0\n" + edge,
                "map.g2o:5: vertex 1 is there already, on line 2; remove one of them");
  expectRefused(vertices + "VERTEX_XY 1 1 0\n" + edge,
                "map.g2o:3: vertex 1 is there already, on line 2; remove one of them");
}
TEST(GraphFaults, PosesAndLandmarksMixedUp) {
  expectRefused(vertices + "VERTEX_XY 7 1 0\nEDGE_SE2 1 7 1 0 0" + unit3,
                "map.g2o:4: vertex 7 must be a pose here, but is a landmark; see line 3");
  expectRefused(vertices + edge + "EDGE_SE2_XY 0 1 1 0 1 0 1\n",
                "map.g2o:4: vertex 1 must be a landmark here, but is a pose; see line 2");
  expectRefused(edge + "EDGE_SE2_XY 0 1 1 0 1 0 1\n",
                "map.g2o:2: vertex 1 is a landmark here and a pose on line 1; give one of them another id");
}
TEST(GraphFaults, SelfEdge) {
  expectRefused("EDGE_SE2 4 4 1 0 0" + unit3, "map.g2o:1: the edge leads from vertex 4 to itself; remove it");
}
TEST(GraphFaults, PlaneAndSpaceMixed) {
  expectRefused(edge + "EDGE_SE3:QUAT 0 1 0 0 0 0 0 0 1" + unit6,
                "map.g2o:2: EDGE_SE3:QUAT and EDGE_SE2 of line 1 do not belong together: one is in the "
                "plane, one in space; "
                "make two files");
  expectRefused("\nVERTEX3 0 0 0 0 0 0 0\n" + edge,
                "map.g2o:3: EDGE_SE2 and VERTEX3 of line 2 do not belong together: one is in the plane, one "
                "in space; make "
                "two files");
}
TEST(GraphFaults, ZeroQuaternion) {
  expectRefused(
      "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 0\n",
      "map.g2o:1: the length of the quaternion is 0 or not finite; write a quaternion of length 1, qx qy qz "
      "qw");
  expectRefused(
      "EDGE_SE3:QUAT 0 1 0 0 0 1e200 0 0 0" + unit6,
      "map.g2o:1: the length of the quaternion is 0 or not finite; write a quaternion of length 1, qx qy qz "
      "qw");
}
TEST(GraphFaults, InformationThatIsNotPositiveDefinite) {
  const std::string bad = "EDGE_SE2 0 1 1 0 0 1 2 0 1 0 1\n";
  expectRefused(vertices + bad,
                "map.g2o: the information of 1 edge is not positive definite (line 3); correct it, or pass "
                "--repair-information to use the nearest positive definite matrix");
  expectRefused(edge + bad + bad + edge + bad + bad + bad + bad,
                "map.g2o: the information of 6 edges is not positive definite (lines 2, 3, 5, 6, 7, ...); "
                "correct it, or pass --repair-information to use the nearest positive definite matrix");
  expectRefused("EDGE_SE2 0 1 1 0 0 1 0 0 1 0 -1\n",
                "map.g2o: the information of 1 edge is not positive definite (line 1); correct it, or pass "
                "--repair-information to use the nearest positive definite matrix");
  for (const auto& options : {std::vector<std::string>{}, std::vector<std::string>{"--repair-information"}}) {
    expectRefused("EDGE_SE2 0 1 1 0 0 0 0 0 0 0 0\n",
                  "map.g2o:1: the information is 0, so nothing is measured; remove the line", options);
  }
}
TEST(GraphFaults, PartsThatNothingConnects) {
  std::string three =
      edge + "EDGE_SE2 5 6 1 0 0" + unit3 + "EDGE_SE2 6 7 1 0 0" + unit3 + "EDGE_SE2 9 8 1 0 0" + unit3;
  expectRefused(three,
                "map.g2o: the graph has 3 parts that no edge connects, and 2 have no fixed pose: the part "
                "of pose 5 (3 "
                "vertices), the part of pose 8 (2 vertices); add edges between them, add a line FIX for a "
                "pose "
                "of each, or pass --hold-parts to fix the first vertex of each");
  expectRefused(three + "FIX 1\nFIX 6\n",
                "map.g2o: the graph has 3 parts that no edge connects, and 1 has no fixed pose: "
                "the part of pose 8 (2 "
                "vertices); add edges between them, add a line FIX for a pose of each, or pass --hold-parts "
                "to fix the first vertex of each");
  expectRefused(vertices + "VERTEX_SE2 2 0 0 0\nVERTEX_XY 3 0 0\n" + edge,
                "map.g2o: the graph has 3 parts that no edge connects, and 2 have no fixed pose: the part "
                "of pose 2 (1 "
                "vertex), the part of landmark 3 (1 vertex); add edges between them, add a line FIX for a "
                "pose "
                "of each, or pass --hold-parts to fix the first vertex of each");
  for (int i = 0; i < 5; ++i)
    three += "EDGE_SE2 " + std::to_string(20 + i) + " " + std::to_string(30 + i) + " 1 0 0" + unit3;
  expectRefused(
      three,
      "map.g2o: the graph has 8 parts that no edge connects, and 7 have no fixed pose: the part of pose 5 "
      "(3 "
      "vertices), the part of pose 8 (2 vertices), the part of pose 20 (2 vertices), the part of pose 21 (2 "
      "vertices), "
      "the part "
      "of pose 22 (2 vertices), ...; add edges between them, add a line FIX for a pose of each, or pass "
      "--hold-parts to fix the first vertex of each");
}
TEST(GraphFaults, FixedPosesWithoutPlaces) {
  expectRefused(edge + "FIX 0 1\n",
                "map.g2o: 2 poses are fixed, but the file has no vertices that give their places; fix one "
                "of them, or add "
                "vertices");
}

}  // namespace
}  // namespace slom::app::graph
