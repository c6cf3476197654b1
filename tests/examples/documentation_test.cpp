// Every fenced block of C++ and CMake in the documentation occurs, letter by letter, in a source that the test suite
// compiles and runs. The output in the README is the real output.
#include "support/documentation.hpp"

#include <filesystem>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/paths.hpp"
#include "support/temporary_folder.hpp"

namespace {

namespace fs = std::filesystem;
using slom::testing::blocks;
using slom::testing::readFile;

/// All sources of examples and tests, one after the other.
std::string sources(const std::string& extension) {
  std::string all;
  for (const char* folder : {"examples", "tests"}) {
    for (const auto& entry : fs::recursive_directory_iterator(slom::testing::sourcePath(folder))) {
      if (entry.is_regular_file() &&
          (entry.path().extension() == extension || entry.path().filename() == extension)) {
        all += readFile(entry.path());
      }
    }
  }
  return all;
}

TEST(Documentation, ShowsCodeThatIsCompiledAndRun) {
  const std::string cpp = sources(".cpp") + sources(".hpp"), cmake = sources("CMakeLists.txt");
  std::vector<fs::path> pages{slom::testing::sourcePath("README.md")};
  for (const auto& entry : fs::recursive_directory_iterator(slom::testing::sourcePath("docs")))
    pages.push_back(entry.path());
  int count = 0;
  for (const fs::path& page : pages) {
    if (page.extension() != ".md") continue;
    for (const std::string& block : blocks(readFile(page), "cpp")) {
      EXPECT_NE(cpp.find(block), std::string::npos) << page << " shows code that is in no example or test:\n"
                                                    << block;
      ++count;
    }
    for (const std::string& block : blocks(readFile(page), "cmake")) {
      EXPECT_NE(cmake.find(block), std::string::npos) << page << " shows a build that no test makes:\n"
                                                      << block;
      ++count;
    }
  }
  EXPECT_GE(count, 9);
}

TEST(Documentation, ShowsWhatTheFirstProgramPrints) {
  const auto printed = blocks(readFile(slom::testing::sourcePath("README.md")), "text");
  ASSERT_FALSE(printed.empty());
  EXPECT_EQ(printed[0], readFile(slom::testing::sourcePath("examples/circle_fit/expected.txt")));
}

TEST(Documentation, ShowsWhatTheProgramOfTheInstallationPrints) {
  const auto printed = blocks(readFile(slom::testing::sourcePath("docs/start/install.md")), "text");
  ASSERT_EQ(printed.size(), 1u);
  EXPECT_EQ(printed[0], readFile(slom::testing::sourcePath("examples/circle_fit/expected.txt")));
}

TEST(Documentation, ShowsWhatTheFirstFitPrints) {
  const auto printed = blocks(readFile(slom::testing::sourcePath("docs/start/first_fit.md")), "text");
  ASSERT_EQ(printed.size(), 3u);
  EXPECT_EQ(printed[0] + "\n" + printed[1] + "\n" + printed[2],
            readFile(slom::testing::sourcePath("examples/first_fit/expected.txt")));
}

TEST(Documentation, ShowsWhatTheProgramOfTheTutorialPrints) {
  const auto printed = blocks(readFile(slom::testing::sourcePath("docs/tutorial.md")), "text");
  ASSERT_EQ(printed.size(), 1u);
  EXPECT_EQ(printed[0], readFile(slom::testing::sourcePath("examples/landmark_slam_2d/expected.txt")));
}

/// Returns the output of the program of docs/background, by page.
std::map<std::string, std::string> backgroundSections() {
  std::map<std::string, std::string> sections;
  std::istringstream printed(readFile(slom::testing::sourcePath("examples/background/expected.txt")));
  std::string page;
  for (std::string line; std::getline(printed, line);) {
    if (line.rfind("== ", 0) == 0) {
      page = line.substr(3);
    } else {
      sections[page] += line + "\n";
    }
  }
  return sections;
}

TEST(Documentation, ShowsWhatTheProgramOfTheBackgroundPrints) {
  const std::map<std::string, std::string> sections = backgroundSections();
  EXPECT_EQ(sections.size(), 11u);
  for (const auto& [name, printed] : sections) {
    const std::string page = readFile(slom::testing::sourcePath("docs/background/" + name + ".md"));
    EXPECT_NE(page.find("](" + name + ".svg)"), std::string::npos) << name << " does not show its picture";
    const auto shown = blocks(page, "text");
    EXPECT_FALSE(shown.empty()) << name;
    for (const std::string& block : shown) {
      const auto at = printed.find(block);
      EXPECT_TRUE(at != std::string::npos && (at == 0 || printed[at - 1] == '\n')) << name << " shows\n"
                                                                                   << block;
    }
  }
}

TEST(Documentation, ShowsWhatTheCalibrationPrints) {
  const auto printed = blocks(readFile(slom::testing::sourcePath("docs/calibration_library.md")), "text");
  ASSERT_EQ(printed.size(), 1u);
  EXPECT_EQ(printed[0], readFile(slom::testing::sourcePath("examples/camera_calibration/expected.txt")));
}

}  // namespace
