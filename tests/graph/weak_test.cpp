// Graphs that hardly determine some of their unknowns.
#include "graph/graph_command.hpp"

namespace slom::app::graph {
namespace {

using testing::Json;
using testing::TemporaryFolder;

/// A ring whose edges contain no information about headings: their information ends with a 0.
std::string withoutHeadings(int poses, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise;
  std::string text = "FIX 0\n";
  for (int i = 0; i < poses; ++i) {
    text += "VERTEX_SE2 " + std::to_string(i) + " " + std::to_string(5 * std::cos(6.283 * i / poses)) + " " +
            std::to_string(5 * std::sin(6.283 * i / poses)) + " 0\n";
    text += "EDGE_SE2 " + std::to_string(i) + " " + std::to_string((i + 1) % poses) + " " +
            std::to_string(31.4 / poses + noise(random)) + " " + std::to_string(noise(random)) +
            " 0 5 0 0 5 0 0\n";
  }
  return text;
}

TEST(GraphWeak, HeadingsWithoutInformationAreNamed) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const std::string content = withoutHeadings(4 + int(seed), seed);
    const TemporaryFolder folder;
    const auto result = testing::runIn(
        folder, content, {"--repair-information", "--json", "DIR/result.json", "--max-iterations", "30"});
    const Json json = Json::parse(slom::testing::readFile(folder / "result.json"));
    ASSERT_FALSE(json["warnings"].empty()) << result.output;
    bool is_said = false;
    for (const Json& warning : json["warnings"]) {
      const std::string text = warning;
      is_said = is_said || (text.find("hardly determined") != std::string::npos &&
                            text.find("orient") != std::string::npos);
    }
    EXPECT_TRUE(is_said) << json["warnings"];
    if (result.exit_code != 0) {
      EXPECT_NE(result.errors.find("hardly determined"), std::string::npos) << result.errors;
    }
  }
}

/// If the repaired information leaves nothing weak, there is no warning.
TEST(GraphWeak, NothingIsSaidWhereAllIsDetermined) {
  const std::string bad = "EDGE_SE2 0 1 1 0 0 1 2 0 1 0 1\n", good = "EDGE_SE2 0 1 0 0 0 3 0 0 3 0 1\n";
  EXPECT_EQ(testing::fitted(bad + good, {"--repair-information"})["warnings"], Json::array());
}

}  // namespace
}  // namespace slom::app::graph
