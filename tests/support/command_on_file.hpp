#pragma once
// A subcommand of slom that reads one file, on files that a test writes.

#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/paths.hpp"
#include "support/replaced.hpp"
#include "support/run_command.hpp"

namespace slom::testing {

struct CommandOnFile {
  std::string subcommand;
  std::string input;                       ///< name of the file that it reads
  std::vector<std::string> all_results{};  ///< options that make it write results into DIR

  CommandResult run(const std::vector<std::string>& options) const {
    std::vector<std::string> words{commandPath().string(), subcommand};
    words.insert(words.end(), options.begin(), options.end());
    return runCommand(words);
  }

  /// Runs on DIR/<input> with `content`; `options` may name other files of the folder by DIR/. Messages are
  /// shown without it.
  CommandResult runIn(const TemporaryFolder& folder, const std::string& content,
                      std::vector<std::string> options) const {
    writeFile(folder / input, content);
    for (std::string& option : options) option = replaced(option, "DIR", folder.path().string());
    options.insert(options.begin(), (folder / input).string());
    CommandResult result = run(options);
    result.errors = replaced(result.errors, folder.path().string() + "/", "");
    result.output = replaced(result.output, folder.path().string() + "/", "");
    return result;
  }

  /// Expects that the command refuses the content with one sentence and leaves no file behind.
  void expectRefused(const std::string& content, const std::string& sentence,
                     std::vector<std::string> options = {}) const {
    const TemporaryFolder folder;
    options.insert(options.end(), all_results.begin(), all_results.end());
    const CommandResult result = runIn(folder, content, options);
    EXPECT_EQ(result.errors, "slom: " + sentence + "\n");
    EXPECT_EQ(result.output, "");
    EXPECT_EQ(result.exit_code, 2);
    for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
      EXPECT_EQ(entry.path().filename(), input) << "was written all the same";
    }
  }
};

}  // namespace slom::testing
