#pragma once
// Runs a program as a user does and keeps its output.

#include <cstdlib>
#include <string>
#include <vector>

#include <sys/wait.h>

#include "support/temporary_folder.hpp"

namespace slom::testing {

struct CommandResult {
  int exit_code;
  std::string output;  ///< standard output
  std::string errors;  ///< standard error
};

/// Runs `words[0]` with the arguments that follow, each taken as it is.
inline CommandResult runCommand(const std::vector<std::string>& words) {
  const TemporaryFolder folder;
  const auto quoted = [](const std::string& word) {
    std::string result = "'";
    for (const char c : word) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return result + "'";
  };
  std::string line;
  for (const std::string& word : words) line += quoted(word) + " ";
  line += ">" + quoted(folder / "output") + " 2>" + quoted(folder / "errors");
  const int status = std::system(line.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), readFile(folder / "output"),
          readFile(folder / "errors")};
}

}  // namespace slom::testing
