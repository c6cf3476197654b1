// Messages of the report about skipped lines.
#include "graph/graph_command.hpp"

namespace slom::app::graph {
namespace {

using testing::parsed;
using testing::unit3;

TEST(GraphUnknownTags, UnknownTagsAreCountedAndCommentsSkipped) {
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

TEST(GraphUnknownTags, OfManyUnknownTagsFiveAreNamed) {
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

TEST(GraphUnknownTags, AreInEveryOutput) {
  const std::string
      skipped = "ODOM 1 2 3\nVERTEX_CAM 1\nODOM\n",
      graph = "EDGE_SE2 0 1 1 0 0" + unit3 + "EDGE_SE2 1 2 1 0 0" + unit3 + skipped,
      said = " (skipped 2 lines with the unknown tag ODOM, skipped 1 line with the unknown tag VERTEX_CAM)";
  EXPECT_EQ(testing::fitted(graph)["warnings"],
            (std::vector<std::string>{"skipped 2 lines with the unknown tag ODOM",
                                      "skipped 1 line with the unknown tag VERTEX_CAM"}));
  testing::expectRefused(
      "EDGE_SE2 7 8 1 0 0" + unit3 + graph,
      "map.g2o: the graph has 2 parts that no edge connects, and 1 has no fixed pose: the part "
      "of pose 7 (2 vertices); add edges between them, add a line FIX for a pose of each, or pass "
      "--hold-parts to fix the first vertex of each" +
          said);
  testing::expectRefused("VERTEX_SE2 0 0 0 0\n" + graph,
                         "map.g2o:2: there is no vertex 1; add a line for it, or remove this one" + said);
  testing::expectRefused(graph + "EDGE_SE2 0 2 1 0 0 0 0 0 0 0 0\n",
                         "map.g2o:6: the information is 0, so nothing is measured; remove the line" + said);
  const testing::TemporaryFolder folder;
  const auto failed =
      testing::runIn(folder, graph + "EDGE_SE2 2 0 1 0 1" + unit3, {"--quiet", "--max-iterations", "1"});
  EXPECT_EQ(
      failed.errors,
      "slom: the fit failed: iteration limit of 1 reached; raise --max-iterations (skipped 2 lines with the unknown tag ODOM; "
      "skipped 1 line with the unknown tag VERTEX_CAM)\n");
  EXPECT_EQ(failed.exit_code, 1);
}

}  // namespace
}  // namespace slom::app::graph
