// The runs that docs/calibrate.md shows are real: each `$ slom ...` line of its console blocks is run, and
// prints what follows it there. In the table of iterations only the first two columns are compared, since the
// others hold rounding errors in the end.
#include <regex>
#include <sstream>

#include <gtest/gtest.h>

#include "calibrate/calibrate_command.hpp"

namespace slom::app::calib {
namespace {

using slom::testing::sourcePath;

std::vector<std::string> blocks(const std::string& page, const std::string& language) {
  std::vector<std::string> result;
  const std::string fence = "```" + language + "\n";
  for (auto at = page.find(fence); at != std::string::npos; at = page.find(fence, at)) {
    at += fence.size();
    result.push_back(page.substr(at, page.find("```", at) - at));
  }
  return result;
}

std::vector<std::string> words(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> result;
  for (std::string word; stream >> word;) result.push_back(word);
  return result;
}

std::string comparable(const std::string& output) {
  const std::regex iteration(R"(( +\d+ +[\d.e+]+) +-?\d\.\d+e.*)");
  return std::regex_replace(output, iteration, "$1");
}

TEST(CalibrateDocumentation, ShowsRealRuns) {
  const slom::testing::TemporaryFolder
      folder;  // the commands write here, and find data/ as in the source tree
  std::filesystem::create_symlink(sourcePath("data"), folder / "data");
  const auto runs = blocks(slom::testing::readFile(sourcePath("docs/calibrate.md")), "console");
  ASSERT_FALSE(runs.empty());
  for (const std::string& run : runs) {
    ASSERT_TRUE(run.starts_with("$ slom ")) << run;
    const std::string line = run.substr(2, run.find('\n') - 2);
    std::vector<std::string> command = words(line);
    command[0] = slom::testing::commandPath().string();
    command.insert(command.begin(), {"/usr/bin/env", "-C", folder.path().string()});
    const auto result = slom::testing::runCommand(command);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_EQ(comparable(result.output), comparable(run.substr(run.find('\n') + 1))) << line;
  }
}

}  // namespace
}  // namespace slom::app::calib
