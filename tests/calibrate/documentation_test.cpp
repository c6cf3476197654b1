// The run in docs/calibrate.md is real: the `$ slom ...` line of its console block prints what follows it there, except
// for the iterations, whose number and last digits depend on rounding errors. The Python in docs/calibrate/results.md,
// which reads the YAML of this run, is run too.
#include "support/documentation.hpp"

#include <gtest/gtest.h>

#include "calibrate/calibrate_command.hpp"

namespace slom::app::calib {
namespace {

using slom::testing::blocks;
using slom::testing::sourcePath;
using slom::testing::withoutIterations;
using slom::testing::words;

TEST(CalibrateDocumentation, ShowsARealFirstCalibration) {
  const std::string page = slom::testing::readFile(sourcePath("docs/start/first_calibration.md"));
  const auto runs = blocks(page, "console");
  ASSERT_EQ(runs.size(), 1u);
  ASSERT_TRUE(runs[0].starts_with("$ slom ")) << runs[0];
  std::vector<std::string> command = words(runs[0].substr(2, runs[0].find('\n') - 2));
  command[0] = slom::testing::commandPath().string();
  const std::string root = sourcePath(".").string();
  command.insert(command.begin(), {"/usr/bin/env", "-C", root});
  const auto result = slom::testing::runCommand(command);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(withoutIterations(result.output), withoutIterations(runs[0].substr(runs[0].find('\n') + 1)));
}

TEST(CalibrateDocumentation, ShowsRealRuns) {
  const slom::testing::TemporaryFolder
      folder;  // the commands write here, and find data/ as in the source tree
  std::filesystem::create_symlink(sourcePath("data"), folder / "data");
  const std::vector<std::string> in_folder{"/usr/bin/env", "-C", folder.path().string()};
  const std::string page = slom::testing::readFile(sourcePath("docs/calibrate.md")),
                    page_of_results = slom::testing::readFile(sourcePath("docs/calibrate/results.md"));
  const auto runs = blocks(page, "console"), scripts = blocks(page_of_results, "python");
  ASSERT_EQ(runs.size(), 1u);
  ASSERT_EQ(scripts.size(), 1u);
  ASSERT_TRUE(runs[0].starts_with("$ slom ")) << runs[0];

  const std::string line = runs[0].substr(2, runs[0].find('\n') - 2);
  std::vector<std::string> command = words(line);
  command[0] = slom::testing::commandPath().string();
  command.insert(command.begin(), in_folder.begin(), in_folder.end());
  const auto result = slom::testing::runCommand(command);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(withoutIterations(result.output), withoutIterations(runs[0].substr(runs[0].find('\n') + 1)));

  std::vector<std::string> python = in_folder;
  python.insert(python.end(),
                {"/usr/bin/python3", "-c", scripts[0] + "print(K.shape, d.shape, R.shape, t.shape)"});
  const auto read = slom::testing::runCommand(python);
  if (read.errors.find("No module named 'cv2'") != std::string::npos)
    GTEST_SKIP() << "needs Debian's python3-opencv";
  EXPECT_EQ(read.output, "(3, 3) (1, 5) (3, 3) (3, 1)\n") << read.errors;
}

}  // namespace
}  // namespace slom::app::calib
