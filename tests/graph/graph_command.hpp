// The command `slom graph` on files that a test writes.
#pragma once

#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "graph/input/read.hpp"
#include "support/command_on_file.hpp"

namespace slom::app::graph::testing {

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

/// What the library part of the command reads from a file with this content.
template <class Pose>
PoseGraph<Pose> parsed(const std::string& content) {
  const TemporaryFolder folder;
  slom::testing::writeFile(folder / "map.g2o", content);
  return std::get<PoseGraph<Pose>>(readPoseGraph((folder / "map.g2o").string()));
}

/// Information matrices that are the identity, row by row.
inline const std::string unit3 = " 1 0 0 1 0 1\n";
inline const std::string unit6 = " 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n";

}  // namespace slom::app::graph::testing
