/// Pages of the documentation as tests read them.
#pragma once

#include <string>
#include <vector>

namespace slom::testing {

/// The contents of all fenced blocks of a language.
inline std::vector<std::string> fencedBlocks(const std::string& page, const std::string& language) {
  std::vector<std::string> result;
  const std::string fence = "```" + language + "\n";
  for (auto at = page.find(fence); at != std::string::npos; at = page.find(fence, at)) {
    at += fence.size();
    result.push_back(page.substr(at, page.find("```", at) - at));
  }
  return result;
}

}  // namespace slom::testing
