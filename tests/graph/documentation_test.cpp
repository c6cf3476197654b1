// The run that docs/graph.md shows is real, but for the iterations.
#include "support/documentation.hpp"

#include "graph/graph_command.hpp"

namespace slom::app::graph {
namespace {

using slom::testing::sourcePath;
using slom::testing::withoutIterations;

TEST(GraphDocumentation, ShowsARealRun) {
  const testing::TemporaryFolder folder;  // the command writes here, and finds data/ as in the source tree
  std::filesystem::create_symlink(sourcePath("data"), folder / "data");
  const auto runs = slom::testing::blocks(slom::testing::readFile(sourcePath("docs/graph.md")), "console");
  ASSERT_EQ(runs.size(), 1u);
  ASSERT_TRUE(runs[0].starts_with("$ slom ")) << runs[0];
  const std::size_t end = runs[0].find('\n');
  std::vector<std::string> command = slom::testing::words(runs[0].substr(2, end - 2));
  command[0] = slom::testing::commandPath().string();
  command.insert(command.begin(), {"/usr/bin/env", "-C", folder.path().string()});
  const auto result = slom::testing::runCommand(command);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(withoutIterations(result.output), withoutIterations(runs[0].substr(end + 1)));
}

}  // namespace
}  // namespace slom::app::graph
