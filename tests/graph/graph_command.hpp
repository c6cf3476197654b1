// The command `slom graph` on files that a test writes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "graph/input/read.hpp"
#include "support/paths.hpp"
#include "support/run_command.hpp"

namespace slom::app::graph::testing {

using Json = nlohmann::json;
using slom::testing::CommandResult;
using slom::testing::TemporaryFolder;

inline CommandResult runGraph(const std::vector<std::string>& options) {
  std::vector<std::string> words{slom::testing::commandPath().string(), "graph"};
  words.insert(words.end(), options.begin(), options.end());
  return slom::testing::runCommand(words);
}

inline std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size()) {
    text.replace(at, what.size(), by);
  }
  return text;
}

/// Runs on DIR/map.g2o with `content`; `options` may name other files of the folder by DIR/. Messages are
/// shown without it.
inline CommandResult runIn(const TemporaryFolder& folder, const std::string& content,
                           std::vector<std::string> options) {
  slom::testing::writeFile(folder / "map.g2o", content);
  for (std::string& option : options) option = replaced(option, "DIR", folder.path().string());
  options.insert(options.begin(), (folder / "map.g2o").string());
  CommandResult result = runGraph(options);
  result.errors = replaced(result.errors, folder.path().string() + "/", "");
  result.output = replaced(result.output, folder.path().string() + "/", "");
  return result;
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

/// What is refused leaves no file behind and says one sentence.
inline void expectRefused(const std::string& content, const std::string& sentence,
                          std::vector<std::string> options = {}) {
  const TemporaryFolder folder;
  options.insert(options.end(), {"--output", "DIR/fitted.g2o", "--json", "DIR/result.json"});
  const CommandResult result = runIn(folder, content, options);
  EXPECT_EQ(result.errors, "slom: " + sentence + "\n");
  EXPECT_EQ(result.output, "");
  EXPECT_EQ(result.exit_code, 2);
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    EXPECT_EQ(entry.path().filename(), "map.g2o") << "was written all the same";
  }
}

/// Information matrices that are the identity, row by row.
inline const std::string unit3 = " 1 0 0 1 0 1\n";
inline const std::string unit6 = " 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n";

}  // namespace slom::app::graph::testing
