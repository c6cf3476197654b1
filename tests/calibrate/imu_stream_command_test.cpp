// `slom calibrate --imu-stream` as its user sees it, on a small simulated recording: results, exit codes, and a sentence
// for each mistake.
#include <algorithm>
#include <filesystem>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "calibrate/calibrate_command.hpp"
#include "calibration/simulated_streams.hpp"
#include "simulate/stereo_imu_stream_files.hpp"
#include "support/replaced.hpp"

namespace slom::app::calib {
namespace {

using nlohmann::json;
using slom::testing::CommandResult;
using slom::testing::readFile;
using slom::testing::replaced;
using slom::testing::TemporaryFolder;
using slom::testing::writeFile;

/// The files of a recording of 6 s.
class ImuStreamCommand : public ::testing::Test {
 protected:
  ImuStreamCommand() { writeStereoImuStream(simulateStereoImuStream(options), options, folder.path()); }

  std::string file(const std::string& name) const { return (folder / name).string(); }
  std::string content(const std::string& name) const { return readFile(folder / name); }
  std::vector<std::string> usual() const {
    return {"--camera",  "cam0=" + file("cam0_corners.csv"),
            "--camera",  "cam1=" + file("cam1_corners.csv"),
            "--board",   "aprilgrid:2x2",
            "--square",  "0.24",
            "--spacing", "0.6",
            "--json",    file("result.json")};
  }
  CommandResult run(std::vector<std::string> more) const {
    std::vector<std::string> words = usual();
    words.insert(words.end(), more.begin(), more.end());
    CommandResult result = testing::runCalibrate(words);
    result.errors = replaced(result.errors, folder.path().string() + "/", "");
    return result;
  }
  std::vector<std::string> imu() const { return {"--imu-stream", "imu0=" + file("imu0.csv")}; }
  /// Expects exit code 2, this sentence and no result.
  void expectRefused(const std::vector<std::string>& more, const std::string& sentence) const {
    const CommandResult result = run(more);
    EXPECT_EQ(result.errors, "slom: " + sentence + "\n");
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_FALSE(std::filesystem::exists(folder / "result.json"));
  }
  /// Expects that the stream with one line (from 1) replaced is refused.
  void expectRowRefused(int line, const std::string& text, const std::string& sentence) const {
    std::string table = content("imu0.csv");
    std::size_t begin = 0;
    for (int i = 1; i < line; ++i) begin = table.find('\n', begin) + 1;
    table.replace(begin, table.find('\n', begin) - begin, text);
    writeFile(folder / "bad.csv", table);
    expectRefused({"--quiet", "--imu-stream", "imu0=" + file("bad.csv")}, sentence);
  }

  StereoImuStreamOptions options = slom::calibration::testing::quickStream(5);
  TemporaryFolder folder;
};

TEST_F(ImuStreamCommand, FindsPoseAndClock) {
  std::vector<std::string> words = imu();
  words.insert(words.end(), {"--imu-noise", "imu0=" + file("imu.yaml"), "--sigma-px", "0.1"});
  const CommandResult result = run(words);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(result.errors, "");
  for (const std::string line :
       {"imu imu0: ", "  time offset ", "  from cam0 to imu0, p_imu0 = R p_cam0 + t:", "  translation.x ",
        "  rotation.z ", "  gyro bias ", "  acc bias ", ", as given; residuals ",
        "gravity in the frame of the board: "})
    EXPECT_NE(result.output.find(line), std::string::npos) << line << "\nis not in\n" << result.output;

  const json got = json::parse(content("result.json")), truth = json::parse(content("truth.json"));
  const json &one = got.at("imus").at("imu0"), &is = truth.at("imus").at("imu0");
  const json& pose = one.at("pose_from_cam0");
  ASSERT_EQ(pose.at("std").size(), 6u);
  for (std::size_t i = 0; i < 9; ++i) {
    EXPECT_NEAR(pose.at("rotation").at(i).get<double>(),
                is.at("pose_from_cam0").at("rotation").at(i).get<double>(), 3e-3);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const double std = pose.at("std").at(i);
    EXPECT_GT(std, 0);
    EXPECT_LT(std, 2e-3);
    EXPECT_NEAR(pose.at("translation").at(i).get<double>(),
                is.at("pose_from_cam0").at("translation").at(i).get<double>(), 5 * std);
    EXPECT_NEAR(one.at("gyro_bias").at(i).get<double>(), is.at("gyro_bias").at(i).get<double>(), 1e-3);
    EXPECT_NEAR(one.at("acc_bias").at(i).get<double>(), is.at("acc_bias").at(i).get<double>(), 3e-2);
    EXPECT_NEAR(got.at("gravity").at(i).get<double>(), truth.at("gravity").at(i).get<double>(), 3e-2);
  }
  const json& offset = one.at("time_offset_s");
  EXPECT_NEAR(offset.at("value").get<double>(), 0.0123, 5 * offset.at("std").get<double>());
  EXPECT_LT(offset.at("std").get<double>(), 1e-4);
  EXPECT_GT(one.at("rms_gyro").get<double>(), 0);
  EXPECT_GT(one.at("rms_acc").get<double>(), 0);
  EXPECT_EQ(one.at("noise").at("is_given"), true);
  EXPECT_EQ(one.at("noise").at("gyroscope_noise_density"), 2e-4);
  EXPECT_NEAR(one.at("noise").at("gyroscope_ratio").get<double>(), 1, 0.4);
  EXPECT_EQ(got.at("streams").at("converged"), true);
  EXPECT_TRUE(got.at("streams").at("undetermined").is_null());
}

TEST_F(ImuStreamCommand, SecondsAndOtherSeparatorsAreRead) {
  std::string table = "t_s wx wy wz ax ay az\n";
  std::istringstream rows(content("imu0.csv"));
  std::string row;
  std::getline(rows, row);
  while (std::getline(rows, row)) {
    std::replace(row.begin(), row.end(), ',', ' ');
    table += row.insert(10, ".") + "\n";  // 1700000000.014150000
  }
  writeFile(folder / "seconds.txt", table);
  const CommandResult result = run({"--quiet", "--imu-stream", "imu0=" + file("seconds.txt")});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const json one = json::parse(content("result.json")).at("imus").at("imu0");
  EXPECT_NEAR(one.at("time_offset_s").at("value").get<double>(), 0.0123, 2e-4);
  EXPECT_EQ(one.at("noise").at("is_given"), false);
}

TEST_F(ImuStreamCommand, OptionsThatDoNotFit) {
  expectRefused(
      {"--imu-noise", "imu0=" + file("imu.yaml")},
      "--imu-noise imu0=imu.yaml: there is no IMU imu0; add --imu-stream imu0=FILE, or correct the name");
  expectRefused({"--imu-stream", "cam1=" + file("imu0.csv")},
                "--imu-stream cam1=imu0.csv: the name cam1 is taken; give each sensor its own");
  expectRefused({"--imu-stream", "a=" + file("imu0.csv"), "--imu-stream", "a=" + file("imu0.csv")},
                "--imu-stream a=imu0.csv: the name a is taken; give each sensor its own");
  expectRefused({"--imu-stream", "a=" + file("imu0.csv"), "--imu-noise", "a=" + file("imu.yaml"),
                 "--imu-noise", "a=" + file("imu.yaml")},
                "--imu-noise a=imu.yaml: the noise of a is given twice; keep one");
  expectRefused({"--quiet", "--imu-stream", "imu0=" + file("lost.csv")},
                "lost.csv: cannot be read (No such file or directory); check the path");
}

TEST_F(ImuStreamCommand, BadRows) {
  expectRowRefused(
      3, "1700000000019150000,0.1,0.2,0.3,9,1",
      "bad.csv:3: the row has 6 fields instead of 7; write time, 3 angular velocities [rad/s], 3 specific "
      "forces [m/s^2]");
  expectRowRefused(4, "1700000000024150000,0.1,fast,0.3,9,1,2",
                   "bad.csv:4: column 3 is \"fast\"; write a number from -1e+06 to 1e+06, or remove the row");
  expectRowRefused(4, "1700000000024150000,0.1,nan,0.3,9,1,2",
                   "bad.csv:4: column 3 is \"nan\"; write a number from -1e+06 to 1e+06, or remove the row");
  expectRowRefused(
      5, "soon,0.1,0.2,0.3,9,1,2",
      "bad.csv:5: the time is \"soon\"; write whole nanoseconds, or seconds with a decimal point");
  expectRowRefused(
      5, "1700000000024150000,0.1,0.2,0.3,9,1,2",
      "bad.csv:5: the time 1700000000024150000 is that of the row before; remove one of the two");
  expectRowRefused(
      5, "1700000000014150000,0.1,0.2,0.3,9,1,2",
      "bad.csv:5: the time 1700000000014150000 is 0.01 s before that of the row before; sort the rows by "
      "time");
}

TEST_F(ImuStreamCommand, BadTables) {
  const auto refuses = [&](const std::string& table, const std::string& sentence) {
    writeFile(folder / "bad.csv", table);
    expectRefused({"--quiet", "--imu-stream", "imu0=" + file("bad.csv")}, sentence);
  };
  const std::string header = "t_ns,wx,wy,wz,ax,ay,az\n";
  refuses(
      "",
      "bad.csv: the file has no readings; write a row for each, with time, 3 angular velocities [rad/s], 3 specific forces [m/s^2]");
  refuses(
      header,
      "bad.csv: the file has no readings; write a row for each, with time, 3 angular velocities [rad/s], 3 specific forces "
      "[m/s^2]");
  refuses(header + "1,0,0,0,0,0,9\n", "bad.csv: there is only one reading; give a recording");
}

TEST_F(ImuStreamCommand, BadNoise) {
  const auto refuses = [&](const std::string& yaml, const std::string& sentence) {
    writeFile(folder / "bad.yaml", yaml);
    std::vector<std::string> words = imu();
    words.insert(words.end(), {"--quiet", "--imu-noise", "imu0=" + file("bad.yaml")});
    expectRefused(words, sentence);
  };
  const std::string good = content("imu.yaml");
  refuses(replaced(good, "accelerometer_random_walk", "walk"),
          "bad.yaml:1: there is no accelerometer_random_walk; give Kalibr's imu.yaml");
  refuses(replaced(good, "gyroscope_noise_density: 0.0002", "gyroscope_noise_density: 0"),
          "bad.yaml:1: gyroscope_noise_density is 0; write a positive number");
}

TEST_F(ImuStreamCommand, StreamsOfOtherUnitsAreNamedByTheirFile) {
  std::string table = "t_ns,wx,wy,wz,ax,ay,az\n";
  for (const ImuSample& s : simulateStereoImuStream(options).imu)
    table += fmt::format("{},{},{},{},{},{},{}\n", 1'700'000'000'014'150'000 + std::llround(s.time * 1e9),
                         s.gyro[0], s.gyro[1], s.gyro[2], s.force[0] / 9.80665, s.force[1] / 9.80665,
                         s.force[2] / 9.80665);
  writeFile(folder / "g.csv", table);
  expectRefused(
      {"--quiet", "--imu-stream", "imu0=" + file("g.csv")},
      "g.csv: the specific forces have a magnitude of 1.01 in the median, as if they were in units of gravity; "
      "multiply them by 9.80665");
}

TEST_F(ImuStreamCommand, ImagesNeedTimes) {
  for (const std::string name : {"cam0_corners.csv", "cam1_corners.csv"}) {
    std::istringstream rows(content(name));
    std::string table = "image,corner,u_px,v_px\n", row;
    std::getline(rows, row);
    while (std::getline(rows, row)) {
      const std::int64_t time = std::stoll(row) - options.epoch_ns;
      table += std::to_string(time / 100'000'000) + row.substr(row.find(',')) + "\n";
    }
    writeFile(folder / name, table);
  }
  std::vector<std::string> words = imu();
  words.push_back("--quiet");
  expectRefused(
      words,
      "cam0_corners.csv: image 0 has no time; give corner files with a column t_ns, or photographs whose names "
      "are times in ns");
}

TEST_F(ImuStreamCommand, ARigAtRestIsRefused) {
  options.motion = SimulatedMotion::rest;
  writeStereoImuStream(simulateStereoImuStream(options), options, folder.path());
  std::vector<std::string> words = imu();
  words.push_back("--quiet");
  const CommandResult result = run(words);
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(result.errors.starts_with(
                  "slom: imu0.csv: the angular velocities and the turns of the cameras correlate by ") &&
              result.errors.ends_with(
                  " at best, so their clocks cannot be compared; give images and readings of the same "
                  "motion, with quick turns about all axes\n"))
      << result.errors;
}

}  // namespace
}  // namespace slom::app::calib
