// The command `slom calibrate` on files that a test writes.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "calibrate/library.hpp"
#include "calibration/simulated_rig.hpp"
#include "support/paths.hpp"
#include "support/run_command.hpp"

namespace slom::app::calib::testing {

using namespace slom::calibration::testing;  // simulated rigs and views

using slom::testing::CommandResult;
using slom::testing::TemporaryFolder;

inline CommandResult runCalibrate(const std::vector<std::string>& options) {
  std::vector<std::string> words{slom::testing::commandPath().string(), "calibrate"};
  words.insert(words.end(), options.begin(), options.end());
  return slom::testing::runCommand(words);
}

const std::string corner_header = "image,corner,world_x_m,world_y_m,world_z_m,u_px,v_px\n";
const std::string imu_header = "image,ax_m_s2,ay_m_s2,az_m_s2,valid\n";

inline std::string cornerFile(const CameraData& camera) {
  std::string text = corner_header;
  for (const View& view : camera.views) {
    for (const Corner& c : view.corners) {
      text += fmt::format("{},{},{},{},{},{},{}\n", view.image, c.number, c.world[0], c.world[1], c.world[2],
                          c.pixel[0], c.pixel[1]);
    }
  }
  return text;
}

/// Runs the command on the corners of the camera, as `cam`. Expects exit code 1 and no YAML.
inline CommandResult runWithUnusableResult(const CameraData& camera) {
  const TemporaryFolder folder;
  slom::testing::writeFile(folder / "cam.csv", cornerFile(camera));
  const CommandResult result =
      runCalibrate({"--camera", "cam=" + (folder / "cam.csv").string(), "--output",
                    (folder / "c.yaml").string(), "--json", (folder / "r.json").string()});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_FALSE(std::filesystem::exists(folder / "c.yaml"));
  return result;
}

inline std::string imuFile(const ImuData& imu) {
  std::string text = imu_header;
  for (const ImuReading& r : imu.readings) {
    text += fmt::format("{},{},{},{},1\n", r.image, r.acc[0], r.acc[1], r.acc[2]);
  }
  return text;
}

}  // namespace slom::app::calib::testing
