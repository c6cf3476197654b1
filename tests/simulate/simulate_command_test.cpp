// The command `slom simulate` as seen by its user: its output, its exit code, and no partially written file.

#include <algorithm>

#include <gtest/gtest.h>

#include "support/paths.hpp"
#include "support/run_command.hpp"

namespace slom::app {
namespace {

using slom::testing::commandPath;
using slom::testing::CommandResult;
using slom::testing::TemporaryFolder;

CommandResult runSimulate(const std::filesystem::path& folder, std::vector<std::string> options) {
  std::vector<std::string> words{commandPath().string(), "simulate", "stereo-imu", "--output",
                                 folder.string()};
  words.insert(words.end(), options.begin(), options.end());
  return slom::testing::runCommand(words);
}

std::vector<std::string> filesIn(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

void expectRefused(const std::vector<std::string>& options, const std::string& sentence) {
  const TemporaryFolder folder;
  const CommandResult result = runSimulate(folder / "out", options);
  EXPECT_EQ(result.errors, sentence + "\n");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.output, "");
  EXPECT_FALSE(std::filesystem::exists(folder / "out")) << "something was written all the same";
}

TEST(SimulateCommand, WritesFourFilesAndSaysSo) {
  const TemporaryFolder folder;
  const CommandResult result = runSimulate(folder / "deep/er", {"--seed", "7", "--images", "4"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(result.errors, "");
  EXPECT_NE(result.output.find("4 images"), std::string::npos) << result.output;
  EXPECT_EQ(filesIn(folder / "deep/er"),
            (std::vector<std::string>{"imu.csv", "left_corners.csv", "right_corners.csv", "truth.json"}));
}

TEST(SimulateCommand, EqualSeedsGiveEqualBytes) {
  const TemporaryFolder folder;
  ASSERT_EQ(runSimulate(folder / "a", {"--seed", "5"}).exit_code, 0);
  ASSERT_EQ(runSimulate(folder / "b", {"--seed", "5"}).exit_code, 0);
  ASSERT_EQ(runSimulate(folder / "c", {"--seed", "6"}).exit_code, 0);
  for (const std::string& name : filesIn(folder / "a")) {
    EXPECT_EQ(slom::testing::readFile(folder / ("a/" + name)),
              slom::testing::readFile(folder / ("b/" + name)))
        << name;
    EXPECT_NE(slom::testing::readFile(folder / ("a/" + name)),
              slom::testing::readFile(folder / ("c/" + name)))
        << name;
  }
}

TEST(SimulateCommand, BadOptionsAreNamedWithTheRemedy) {
  expectRefused(
      {"--images", "2"},
      "slom: --images is 2; give a whole number from 3, below which no camera can be calibrated, to 10000");
  expectRefused({"--images", "many"},
                "slom: --images is many; give a whole number from 3, below which no camera can be "
                "calibrated, to 10000");
  expectRefused({"--seed", "1.5"}, "slom: --seed is 1.5; give a whole number from 0 to 18446744073709551615");
  expectRefused({"--sigma-px", "nan"},
                "slom: --sigma-px is nan; give a standard deviation in px, 0 for corners without noise");
  expectRefused(
      {"--sigma-acc", "0.05m"},
      "slom: --sigma-acc is 0.05m; give a standard deviation in m/s^2, 0 for readings without noise");
}

TEST(SimulateCommand, FolderThatCannotBeMadeIsNamed) {
  const TemporaryFolder folder;
  slom::testing::writeFile(folder / "file", "");
  const std::string inside = (folder / "file/out").string();
  const CommandResult result = runSimulate(inside, {});
  EXPECT_EQ(result.errors, "slom: cannot make the folder " + inside +
                               ": Not a directory; give --output a folder that can be written\n");
  EXPECT_EQ(result.exit_code, 2);
}

/// The last of the four files cannot be written. None of them appears, not even in part.
TEST(SimulateCommand, AllFilesOrNone) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "out/truth.json");
  const CommandResult result = runSimulate(folder / "out", {});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.errors, "slom: cannot write " + (folder / "out/truth.json").string() +
                               ": it is a folder; name a file in a folder that exists and may be written\n");
  EXPECT_EQ(filesIn(folder / "out"), std::vector<std::string>{"truth.json"});
}

}  // namespace
}  // namespace slom::app
