// What the report says of lines that it skips.
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

}  // namespace
}  // namespace slom::app::graph
