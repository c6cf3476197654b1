// The command `slom graph` on files that a test writes.
#pragma once

#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "graph/pose_graph.hpp"
#include "io/parsed_graph.hpp"
#include "io/simulated_graph.hpp"
#include "support/command_on_file.hpp"

namespace slom::app::graph::testing {

using io::testing::parsed;
using io::testing::randomVector;
using io::testing::scrambled;
using io::testing::simulateGraph;
using io::testing::unit3;
using io::testing::unit6;
using Json = nlohmann::json;
using slom::testing::CommandResult;
using slom::testing::replaced;
using slom::testing::TemporaryFolder;

inline const slom::testing::CommandOnFile command{
    "graph", "map.g2o", {"--output", "DIR/fitted.g2o", "--json", "DIR/result.json"}};

inline CommandResult runGraph(const std::vector<std::string>& options) { return command.run(options); }
inline CommandResult runIn(const TemporaryFolder& folder, const std::string& content,
                           const std::vector<std::string>& options) {
  return command.runIn(folder, content, options);
}
inline void expectRefused(const std::string& content, const std::string& sentence,
                          const std::vector<std::string>& options = {}) {
  command.expectRefused(content, sentence, options);
}

/// The JSON of a fit that must converge.
inline Json fitted(const std::string& content, std::vector<std::string> options = {}) {
  const TemporaryFolder folder;
  options.insert(options.end(), {"--quiet", "--json", "-"});
  const CommandResult result = runIn(folder, content, options);
  EXPECT_EQ(result.errors, "");
  EXPECT_EQ(result.exit_code, 0);
  return result.exit_code == 0 ? Json::parse(result.output) : Json();
}

/// The fitted graph, line by line.
inline std::string fittedGraph(const std::string& content, std::vector<std::string> options = {}) {
  const TemporaryFolder folder;
  options.insert(options.end(), {"--quiet", "--output", "DIR/fitted.g2o"});
  const CommandResult result = runIn(folder, content, options);
  EXPECT_EQ(result.errors, "");
  EXPECT_EQ(result.output, "");
  EXPECT_EQ(result.exit_code, 0);
  return result.exit_code == 0 ? slom::testing::readFile(folder / "fitted.g2o") : "";
}

}  // namespace slom::app::graph::testing
