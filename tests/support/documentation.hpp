#pragma once
// Contents of pages of the documentation: fenced blocks, and the runs in them.

#include <regex>
#include <sstream>
#include <string>
#include <vector>

namespace slom::testing {

/// The contents of all blocks of `page` that are fenced with the name of this language.
inline std::vector<std::string> blocks(const std::string& page, const std::string& language) {
  std::vector<std::string> result;
  const std::string fence = "```" + language + "\n";
  for (auto at = page.find(fence); at != std::string::npos; at = page.find(fence, at)) {
    at += fence.size();
    result.push_back(page.substr(at, page.find("```", at) - at));
  }
  return result;
}

inline std::vector<std::string> words(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> result;
  for (std::string word; stream >> word;) result.push_back(word);
  return result;
}

/// Returns the output of a fit without the lines of the iterations, whose number and last digits depend on rounding
/// errors.
inline std::string withoutIterations(const std::string& output) {
  const std::regex line(R"(\n +\d+ +[\d.e+]+( +-?[\d.]+e[-+]\d+){3} +[-\w ]+)"),
      count(R"(after \d+ iterations?)");
  return std::regex_replace(std::regex_replace(output, line, ""), count, "after some iterations");
}

}  // namespace slom::testing
