#pragma once
// Runs of the command that pages of the documentation show.

#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/documentation.hpp"
#include "support/paths.hpp"
#include "support/run_command.hpp"

namespace slom::testing {

/// Expects that the page's only `console` block is a run of slom with real output, except for the iterations.
inline void expectRealRun(const std::string& page) {
  const TemporaryFolder folder;  // the command writes here, and finds data/ as in the source tree
  std::filesystem::create_symlink(sourcePath("data"), folder / "data");
  const auto runs = blocks(readFile(sourcePath(page)), "console");
  ASSERT_EQ(runs.size(), 1u);
  ASSERT_TRUE(runs[0].starts_with("$ slom ")) << runs[0];
  const std::size_t end = runs[0].find('\n');
  std::vector<std::string> command = words(runs[0].substr(2, end - 2));
  command[0] = commandPath().string();
  command.insert(command.begin(), {"/usr/bin/env", "-C", folder.path().string()});
  const auto result = runCommand(command);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(withoutIterations(result.output), withoutIterations(runs[0].substr(end + 1)));
}

}  // namespace slom::testing
