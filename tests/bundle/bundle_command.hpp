// The command `slom bundle` on files that a test writes.
#pragma once

#include <nlohmann/json.hpp>

#include "bundle/raw_scene.hpp"
#include "support/command_on_file.hpp"

namespace slom::app::bundle::testing {

using Json = nlohmann::json;
using slom::testing::CommandResult;
using slom::testing::replaced;
using slom::testing::TemporaryFolder;

inline const slom::testing::CommandOnFile command{
    "bundle",
    "scene.txt",
    {"--output", "DIR/fitted.txt", "--output", "DIR/fitted.ply", "--json", "DIR/result.json"}};

struct Fitted {
  Json json;
  RawScene scene;
  std::string bal, ply;
};

/// Returns the output of a fit that must converge.
inline Fitted fitted(const std::string& content, std::vector<std::string> options = {}) {
  const TemporaryFolder folder;
  options.insert(options.end(), command.all_results.begin(), command.all_results.end());
  options.push_back("--quiet");
  const CommandResult result = command.runIn(folder, content, options);
  EXPECT_EQ(result.output + result.errors, "");
  EXPECT_EQ(result.exit_code, 0);
  if (result.exit_code != 0) return {};
  const std::string bal = slom::testing::readFile(folder / "fitted.txt");
  return {Json::parse(slom::testing::readFile(folder / "result.json")), sceneOf(bal), bal,
          slom::testing::readFile(folder / "fitted.ply")};
}
inline Fitted fitted(const RawScene& scene, const std::vector<std::string>& options = {}) {
  return fitted(contentOf(scene), options);
}

}  // namespace slom::app::bundle::testing
