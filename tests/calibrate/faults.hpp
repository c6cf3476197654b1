// Files that a test damages in its own way, and the expected message of the command.
#pragma once

#include <cstdio>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "calibrate/calibrate_command.hpp"
#include "support/command_on_file.hpp"

namespace slom::app::calib::testing {

/// A small stereo rig with an IMU, whose files each test damages in its own way.
struct Files {
  std::string left, right, imu;

  Files() {
    RigOptions options;
    options.images = 3;
    options.columns = options.rows = 4;
    options.square_m = 0.08;
    std::mt19937_64 random(1);
    const auto truth = simulateTruth(options, random);
    const Dataset data = simulateMeasurements(truth, options, random);
    left = cornerFile(data.cameras[0]);
    right = cornerFile(data.cameras[1]);
    imu = imuFile(*data.imu);
  }
};

using slom::testing::replaced;

/// Line `number` (from 1) replaced; "" removes it.
inline std::string withLine(const std::string& text, int number, const std::string& line) {
  std::size_t begin = 0;
  for (int i = 1; i < number; ++i) begin = text.find('\n', begin) + 1;
  const std::size_t end = text.find('\n', begin) + 1;
  return text.substr(0, begin) + (line.empty() ? "" : line + "\n") + text.substr(end);
}

/// The rows (below the header) that `keep(image, corner)` accepts.
template <class Keep>
std::string filtered(const std::string& text, Keep keep) {
  std::string result;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = text.find('\n', begin) + 1;
    const std::string line = text.substr(begin, end - begin);
    int image = 0, corner = 0;
    if (std::sscanf(line.c_str(), "%d,%d,", &image, &corner) != 2 || keep(image, corner)) result += line;
    begin = end;
  }
  return result;
}

/// Runs with the three files and `options`, which may name them by DIR/left.csv and so on.
inline CommandResult runIn(const TemporaryFolder& folder, const Files& files,
                           std::vector<std::string> options) {
  slom::testing::writeFile(folder / "left.csv", files.left);
  slom::testing::writeFile(folder / "right.csv", files.right);
  slom::testing::writeFile(folder / "imu.csv", files.imu);
  for (std::string& option : options) option = replaced(option, "DIR", folder.path().string());
  auto result = runCalibrate(options);
  result.errors = replaced(result.errors, folder.path().string() + "/", "");
  return result;
}

inline std::vector<std::string> usual() {
  return {"--camera", "left=DIR/left.csv", "--camera", "right=DIR/right.csv", "--imu",   "DIR/imu.csv",
          "--json",   "DIR/result.json",   "--output", "DIR/result.yaml",     "--quiet", "--intrinsics",
          "radial1"};
}

inline void expectRefused(const Files& files, const std::vector<std::string>& options,
                          const std::string& sentence) {
  const TemporaryFolder folder;
  const auto result = runIn(folder, files, options);
  EXPECT_EQ(result.errors, "slom: " + sentence + "\n");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.output, "");
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    const std::string name = entry.path().filename();
    EXPECT_TRUE(name == "left.csv" || name == "right.csv" || name == "imu.csv")
        << name << " was written all the same";
  }
}

inline void expectDataRefused(const Files& files, const std::string& sentence) {
  expectRefused(files, usual(), sentence);
}

}  // namespace slom::app::calib::testing
