// `slom calibrate --camera-offsets` and `--rolling-shutter` with an IMU in motion, as their user sees them.
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <yaml-cpp/yaml.h>

#include "calibrate/calibrate_command.hpp"
#include "calibration/simulated_streams.hpp"
#include "simulate/stereo_imu_stream_files.hpp"
#include "support/replaced.hpp"

namespace slom::app::calib {
namespace {

using nlohmann::json;
using slom::testing::CommandResult;
using slom::testing::readFile;
using slom::testing::TemporaryFolder;

/// The files of a recording of 6 s, with unsynchronised cameras that read their rows one after another.
class MovingCamerasCommand : public ::testing::Test {
 protected:
  MovingCamerasCommand() {
    options.camera_offset = 0.003;
    options.camera_phase = 0.02;
    options.line_delay = 3e-5;
    writeStereoImuStream(simulateStereoImuStream(options), options, folder.path());
  }

  std::string file(const std::string& name) const { return (folder / name).string(); }
  json content(const std::string& name) const { return json::parse(readFile(folder / name)); }
  CommandResult run(int cameras, const std::vector<std::string>& more) const {
    std::vector<std::string> words{"--board",   "aprilgrid:2x2", "--square", "0.24",
                                   "--spacing", "0.6",           "--json",   file("result.json"),
                                   "--quiet",   "--sigma-px",    "0.1"};
    for (int c = 0; c < cameras; ++c) {
      const std::string name = "cam" + std::to_string(c);
      words.insert(words.end(),
                   {"--camera", name + "=" + file(name + "_corners.csv"), "--image-size", name + "=752x480"});
    }
    words.insert(words.end(), more.begin(), more.end());
    return testing::runCalibrate(words);
  }
  std::vector<std::string> withImu(std::vector<std::string> more) const {
    more.insert(more.end(),
                {"--imu-stream", "imu0=" + file("imu0.csv"), "--imu-noise", "imu0=" + file("imu.yaml")});
    return more;
  }
  void expectRefused(int cameras, const std::vector<std::string>& more, const std::string& sentence) const {
    const CommandResult result = run(cameras, more);
    EXPECT_EQ(result.errors, "slom: " + sentence + "\n");
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_FALSE(std::filesystem::exists(folder / "result.json"));
  }
  /// Expects a number within 5 of its standard deviations, which must be below `most`.
  static void expectNear(const json& number, double value, double most) {
    EXPECT_NEAR(number.at("value").get<double>(), value, 5 * number.at("std").get<double>());
    EXPECT_LT(number.at("std").get<double>(), most);
    EXPECT_GT(number.at("std_clustered").get<double>(), 0);
  }

  StereoImuStreamOptions options = slom::calibration::testing::quickStream(7);
  TemporaryFolder folder;
};

TEST_F(MovingCamerasCommand, FindsClocksAndShutters) {
  const CommandResult result = run(2, withImu({"--camera-offsets", "--rolling-shutter", "--intrinsics",
                                               "opencv4", "--output", file("camchain.yaml")}));
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const json got = content("result.json"), truth = content("truth.json");
  EXPECT_EQ(got.at("streams").at("path"), "splines");
  const json &cameras = got.at("streams").at("cameras"), &is = truth.at("streams").at("cameras");
  EXPECT_TRUE(cameras.at("cam0").at("time_offset_s").is_null());
  EXPECT_EQ(is.at("cam1").at("time_offset_s").at("value"), 0.003);
  expectNear(cameras.at("cam1").at("time_offset_s"), 0.003, 1e-4);
  for (const char* camera : {"cam0", "cam1"}) {
    EXPECT_EQ(is.at(camera).at("line_delay_s").at("value"), 3e-5);
    expectNear(cameras.at(camera).at("line_delay_s"), 3e-5, 3e-7);
  }
  const json& pose = cameras.at("cam1").at("pose_from_cam0");
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(pose.at("translation").at(i).get<double>(),
                truth.at("cameras").at("cam1").at("pose_from_cam0").at("translation").at(i).get<double>(),
                5 * pose.at("std").at(i).get<double>());
  const double imu_offset = got.at("imus").at("imu0").at("time_offset_s").at("value");
  EXPECT_NEAR(imu_offset, options.time_offset, 2e-4);
  const YAML::Node chain = YAML::LoadFile(file("camchain.yaml"));
  EXPECT_NEAR(chain["cam0"]["timeshift_cam_imu"].as<double>(), imu_offset, 1e-12);
  EXPECT_NEAR(chain["cam1"]["timeshift_cam_imu"].as<double>(),
              imu_offset - cameras.at("cam1").at("time_offset_s").at("value").get<double>(), 1e-12);
}

TEST_F(MovingCamerasCommand, BothPathsAreCompared) {
  const CommandResult result =
      run(2, withImu({"--camera-offsets", "--rolling-shutter", "--imu-motion", "both"}));
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const json streams = content("result.json").at("streams");
  EXPECT_EQ(streams.at("path"), "splines");
  EXPECT_TRUE(streams.at("agreement").at("contradiction").is_null()) << streams.at("agreement");
}

TEST_F(MovingCamerasCommand, FaultsAreNamed) {
  expectRefused(
      2, {"--camera-offsets"},
      "--camera-offsets: there is no IMU in motion; add --imu-stream NAME=FILE or drop this option");
  expectRefused(1, withImu({"--camera-offsets"}),
                "--camera-offsets: there is one camera only; add another one or drop this option");
  for (const char* option : {"--camera-offsets", "--rolling-shutter"})
    expectRefused(
        2, withImu({option, "--imu-motion", "preintegration"}),
        std::string(option) + ": with an --imu-stream, needs splines; drop --imu-motion preintegration");
}

}  // namespace
}  // namespace slom::app::calib
