// The folders of tests are those of the library and of the subcommands, so that the tests of a folder are easy to find.
#include <filesystem>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "support/paths.hpp"

namespace slom::testing {
namespace {

namespace fs = std::filesystem;

/// All other folders, and their subjects.
const std::map<std::string, std::string> others{
    {"calibrate_reference", "OpenCV's calibration of the same images, for tests/calibrate to compare with"},
    {"coming_from", "the problems of docs/coming_from by other libraries"},
    {"command", "the files beside the subcommands, apps/slom/*.cpp"},
    {"compile_fail", "sources that must not compile"},
    {"detect", "a folder of apps/slom/calibrate"},
    {"filter_alone", "filters without the library, on this machine and on an emulated microcontroller"},
    {"filter_data", "filters on recorded data, which are read by slom::io"},
    {"docs", "the pages, the site that is made of them, and the comments of the public headers"},
    {"examples", "examples/ and the code in pages"},
    {"fuzz", "readers and fits, on any bytes"},
    {"install", "projects of users"},
    {"listings", "the listings of the paper"},
    {"members", "names of members of plain structs, which g++ alone knows"},
    {"nist", "certified values for the whole fit"},
    {"python", "the Python package"},
    {"report", "the report of slom calibrate, in a browser"},
    {"structure", "the sources themselves"},
    {"support", "what tests share"},
    {"threads", "whole fits and solvers, which run under the thread sanitizer alone"},
};

/// A folder of the library, a header of the facade, or a subcommand.
bool isSubject(const std::string& name) {
  const fs::path root = sourcePath(".");
  return fs::is_directory(root / "include" / name) || fs::is_directory(root / "include/slom" / name) ||
         fs::is_directory(root / "src" / name) || fs::exists(root / "include/slom" / (name + ".hpp")) ||
         fs::is_directory(root / "apps/slom" / name);
}

TEST(Folders, OfTestsAreThoseOfWhatTheyTest) {
  int subjects = 0;
  for (const auto& entry : fs::directory_iterator(sourcePath("tests"))) {
    if (!entry.is_directory()) continue;
    const std::string name = entry.path().filename().string();
    const bool is_subject = isSubject(name), is_other = others.count(name) > 0;
    subjects += is_subject ? 1 : 0;
    EXPECT_TRUE(is_subject || is_other)
        << "tests/" << name
        << " is neither a folder of include/, src/ or apps/slom nor listed in this test; move its tests "
        << "to the folder of what they test, or list it with a reason";
    EXPECT_FALSE(is_subject && is_other) << "tests/" << name << " needs no reason; remove it from this test";
  }
  EXPECT_GT(subjects, 10);
  for (const auto& [name, reason] : others)
    EXPECT_TRUE(fs::is_directory(sourcePath("tests/" + name))) << name << ", " << reason << ", is gone";
}

/// A step of the data flow without a folder of tests is tested by others; which, stands here.
TEST(Folders, OfTheLibraryHaveTests) {
  const std::map<std::string, std::string> without{};
  for (const auto& entry : fs::directory_iterator(sourcePath("src"))) {
    const std::string name = entry.path().filename().string();
    if (!entry.is_directory() || without.count(name) > 0) continue;
    EXPECT_TRUE(fs::is_directory(sourcePath("tests/" + name))) << "src/" << name << " has no folder of tests";
  }
}

}  // namespace
}  // namespace slom::testing
