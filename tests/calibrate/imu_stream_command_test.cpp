// `slom calibrate --imu-stream` as its user sees it, on a small simulated recording: results, exit codes, and a sentence
// for each mistake.
#include <algorithm>
#include <cmath>
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
  /// Expects exit code 2, this sentence, and the result of the cameras.
  void expectCamerasAlone(const std::vector<std::string>& more, const std::string& sentence) const {
    const CommandResult result = run(more);
    EXPECT_EQ(result.errors, "slom: " + sentence + "\n");
    EXPECT_EQ(result.exit_code, 2);
    const json got = json::parse(content("result.json"));
    EXPECT_EQ(replaced(got.at("streams").at("refused"), folder.path().string() + "/", ""), sentence);
    EXPECT_EQ(got.at("streams").at("verdict").at("level"), "failed");
    EXPECT_EQ(got.at("imus"), json::object());
    EXPECT_NE(got.at("quality").at("verdict").at("level"), "failed");
    EXPECT_EQ(got.at("converged"), true);
    EXPECT_EQ(got.at("cameras").size(), 2u);
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
        "  rotation.z ", "  gyro_bias.x ", "  acc_bias.z ", ", as given; residuals ",
        "gravity in the frame of the board: ", "  halves of the recording differ by (",
        "\nverdict on the IMU: trustworthy\n  * The pose of imu0 is known to "})
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
  EXPECT_EQ(got.at("streams").at("verdict").at("level"), "trustworthy");
  EXPECT_EQ(got.at("streams").at("verdict").at("doubts"), json::array());
  EXPECT_LT(std::abs(one.at("halves").at("time_offset_s").get<double>()), 1e-3);
  EXPECT_TRUE(got.at("streams").at("undetermined").is_null());
}

TEST_F(ImuStreamCommand, BothPathsAreCompared) {
  std::vector<std::string> words = imu();
  words.insert(words.end(),
               {"--imu-noise", "imu0=" + file("imu.yaml"), "--sigma-px", "0.1", "--imu-motion", "both"});
  const CommandResult result = run(words);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  for (const std::string line :
       {"\nIMUs by splines\n", "\nimu imu0: splines minus preintegration\n  time offset ",
        "\n  translation.x ", "\n  rotation.z ", " standard deviations\n"})
    EXPECT_NE(result.output.find(line), std::string::npos) << line << "\nis not in\n" << result.output;
  const json streams = json::parse(content("result.json")).at("streams");
  EXPECT_EQ(streams.at("path"), "preintegration");
  const json &agreement = streams.at("agreement"), &one = agreement.at("imus").at("imu0");
  EXPECT_TRUE(agreement.at("contradiction").is_null()) << agreement;
  EXPECT_GT(agreement.at("largest"), 0);
  EXPECT_LT(agreement.at("largest"), 3);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_GT(one.at("translation_std").at(i), 0);
    EXPECT_NEAR(one.at("translation").at(i).get<double>(), 0, 2e-3);
  }
}

TEST_F(ImuStreamCommand, SplinesReplacePreintegration) {
  std::vector<std::string> words = imu();
  words.insert(words.end(), {"--quiet", "--imu-noise", "imu0=" + file("imu.yaml"), "--imu-motion", "splines",
                             "--knot-spacing", "0.08"});
  const CommandResult result = run(words);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(result.output, "");
  const json got = json::parse(content("result.json"));
  EXPECT_EQ(got.at("streams").at("path"), "splines");
  EXPECT_FALSE(got.at("streams").contains("agreement"));
  const json& offset = got.at("imus").at("imu0").at("time_offset_s");
  EXPECT_NEAR(offset.at("value").get<double>(), 0.0123, 5 * offset.at("std").get<double>());
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

/// The same stream with its times in another unit.
TEST_F(ImuStreamCommand, TheHeaderGivesTheUnitOfTimes) {
  const auto firstAndLast = [&](const std::string& column, std::size_t digits, const char* point) {
    std::string table = column + ",wx,wy,wz,ax,ay,az\n";
    std::istringstream rows(content("imu0.csv"));
    std::string row;
    std::getline(rows, row);
    while (std::getline(rows, row)) table += row.insert(digits, point) + "\n";
    writeFile(folder / "unit.csv", table);
    const calibration::ImuStream imu = calibration::readImuStream("imu0", file("unit.csv"));
    return std::pair(imu.epoch_ns, imu.samples.back().time);
  };
  const auto is = firstAndLast("#timestamp [ns]", 19, "");
  for (const std::string us : {"t_us", "#timestamp [us]", "timestamp_us", "Time(us)"})
    EXPECT_EQ(firstAndLast(us, 16, "."), is) << us;
  EXPECT_EQ(firstAndLast("t_ms", 13, "."), is);
  EXPECT_EQ(firstAndLast("time [s]", 10, "."), is);
}

TEST_F(ImuStreamCommand, TimesThatAreNoNanosecondsAreNamed) {
  const std::string rows = ",0,0,0,0,0,9\n";
  const auto refuses = [&](const std::string& table, const std::string& sentence) {
    writeFile(folder / "bad.csv", table);
    expectRefused({"--quiet", "--imu-stream", "imu0=" + file("bad.csv")}, sentence);
  };
  refuses(
      "time,wx,wy,wz,ax,ay,az\n1403715273262142" + rows + "1403715273267142" + rows,
      "bad.csv: readings follow each other by 5e-06 s if their times are nanoseconds, as if they were microseconds; "
      "write t_us in the header");
  refuses(
      "5" + rows + "10" + rows,
      "bad.csv: readings follow each other by 5e-09 s if their times are nanoseconds, as if they were milliseconds; "
      "write t_ms in the header");
  refuses(
      "#timestamp [ns]\n1403715273.262" + rows + "1403715273.267" + rows,
      "bad.csv:3: the time 1403715273.267 is less than 1 ns after 1403715273.262; correct the unit in the header");
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
  expectRefused(
      {"--imu-motion", "both"},
      "--imu-motion both: there is no IMU in motion; add --imu-stream NAME=FILE or drop this option");
  const auto refuses = [&](std::vector<std::string> more, const std::string& sentence) {
    const std::vector<std::string> stream = imu();
    more.insert(more.end(), stream.begin(), stream.end());
    expectRefused(more, sentence);
  };
  refuses(
      {"--imu-reads", "gravity"},
      "--imu-reads gravity: the option is for --imu; drop it, and if the accelerometer of an --imu-stream reports "
      "gravity itself at rest, change the sign of its three columns");
  refuses({"--imu-motion", "spline"},
          "--imu-motion spline: unknown motion; give preintegration, splines or both");
  refuses({"--knot-spacing", "0.02"},
          "--knot-spacing 0.02: needs splines; add --imu-motion splines or both, or drop this option");
  refuses({"--imu-motion", "splines", "--knot-spacing", "0"},
          "--knot-spacing 0: spacing out of range; give 0.001 to 10 s");
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
      "bad.csv:5: the time is \"soon\"; write whole nanoseconds, or t_s in the header and seconds");
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
  expectCamerasAlone(
      {"--quiet", "--imu-stream", "imu0=" + file("g.csv")},
      "g.csv: the specific forces have a magnitude of 1.01 in the median, as if they were in units of gravity; "
      "multiply them by 9.80665");
}

/// OpenVINS' files have the poses of the JSON, and Basalt's file the lens and the clock, too.
TEST_F(ImuStreamCommand, OtherProgramsGetTheirFiles) {
  const std::vector<std::string> sizes{"--intrinsics", "opencv4", "--image-size", "752x480", "--quiet"};
  const auto with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = imu();
    words.insert(words.end(), sizes.begin(), sizes.end());
    words.insert(words.end(), more.begin(), more.end());
    const CommandResult result = run(words);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return json::parse(content("result.json"));
  };
  const json basalt_result = with({"--format", "basalt", "--output", file("calibration.json")});
  const json basalt = json::parse(content("calibration.json")).at("value0");
  const json& one = basalt_result.at("imus").at("imu0");
  const json& place = one.at("pose_from_cam0").at("translation");
  ASSERT_EQ(basalt.at("T_imu_cam").size(), 2u);
  const json& first = basalt.at("T_imu_cam").at(0);
  for (const auto& [i, key] : {std::pair(0, "px"), {1, "py"}, {2, "pz"}})
    EXPECT_EQ(first.at(key).get<double>(), place.at(std::size_t(i)).get<double>());
  const SO3 turn(first.at("qw").get<double>(), first.at("qx").get<double>(), first.at("qy").get<double>(),
                 first.at("qz").get<double>());
  const Eigen::Matrix3d R = turn.toRotationMatrix();
  for (int i = 0; i < 9; ++i)
    EXPECT_NEAR(R(i / 3, i % 3), one.at("pose_from_cam0").at("rotation").at(std::size_t(i)).get<double>(),
                1e-12);
  const json& parameters = basalt_result.at("cameras").at("cam1").at("parameters");
  const json& lens = basalt.at("intrinsics").at(1);
  EXPECT_EQ(lens.at("camera_type"), "pinhole-radtan8");
  for (const std::string name : {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2"})
    EXPECT_EQ(lens.at("intrinsics").at(name), parameters.at(name).at("value")) << name;
  EXPECT_EQ(lens.at("intrinsics").at("k6"), 0);
  EXPECT_EQ(basalt.at("cam_time_offset_ns").get<std::int64_t>(),
            std::llround(1e9 * one.at("time_offset_s").at("value").get<double>()));
  EXPECT_EQ(basalt.at("calib_accel_bias").size(), 9u);
  EXPECT_EQ(basalt.at("calib_gyro_bias").size(), 12u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(basalt.at("calib_accel_bias").at(i).get<double>(), one.at("acc_bias").at(i).get<double>(),
                1e-15);
    EXPECT_NEAR(basalt.at("calib_gyro_bias").at(i).get<double>(), one.at("gyro_bias").at(i).get<double>(),
                1e-15);
  }

  with({"--output", file("kalibr_imucam_chain.yaml")});
  const std::string cameras = content("kalibr_imucam_chain.yaml"), sensor = content("kalibr_imu_chain.yaml");
  EXPECT_TRUE(cameras.starts_with("%YAML:1.0\n")) << cameras;
  for (const std::string key :
       {"T_imu_cam:", "cam_overlaps: [1]", "distortion_model: radtan", "timeshift_cam_imu:"})
    EXPECT_NE(cameras.find(key), std::string::npos) << key << " is not in\n" << cameras;
  for (const std::string key :
       {"gyroscope_noise_density:", "update_rate: 200", "model: kalibr", "R_IMUtoGYRO:", "Tg:"})
    EXPECT_NE(sensor.find(key), std::string::npos) << key << " is not in\n" << sensor;
  std::filesystem::remove(folder / "result.json");
  expectRefused({"--format", "basalt", "--output", file("b.json")},
                "--output b.json: Basalt needs the pose of an IMU; add --imu-stream NAME=FILE");
}

/// Lenses of a camchain are held, and folders are read as EuRoC has them.
TEST_F(ImuStreamCommand, KnownLensesAndFolders) {
  const json truth = json::parse(content("truth.json"));
  std::filesystem::create_directories(folder / "imu0");
  std::filesystem::copy(folder / "imu0.csv", folder / "imu0" / "data.csv");
  std::filesystem::copy(folder / "imu.yaml", folder / "imu0" / "sensor.yaml");
  writeFile(
      folder / "chain.yaml",
      "cam0:\n  camera_model: pinhole\n  intrinsics: [461.5, 460.25, 370, 242]\n  distortion_model: radtan\n"
      "  distortion_coeffs: [-0.29, 0.08, 0.0002, 0.0001]\n  resolution: [752, 480]\n"
      "cam1:\n  camera_model: pinhole\n  intrinsics: [460, 459, 375, 250]\n  distortion_model: radtan\n"
      "  distortion_coeffs: [-0.28, 0.07, 0.0001, -0.0001]\n  resolution: [752, 480]\n");
  const std::vector<std::string> imu_folder{"--quiet", "--imu-stream", "imu0=" + file("imu0"), "--imu-noise",
                                            "imu0=" + file("imu0")};
  std::vector<std::string> words = imu_folder;
  words.insert(words.end(), {"--lenses", file("chain.yaml")});
  const CommandResult held = run(words);
  EXPECT_EQ(held.exit_code, 0) << held.errors;
  const json cameras = json::parse(content("result.json")).at("cameras");
  EXPECT_EQ(cameras.at("cam0").at("model"), "opencv4");
  EXPECT_EQ(cameras.at("cam0").at("parameters").at("fy").at("value"), 460.25);
  EXPECT_EQ(cameras.at("cam1").at("parameters").at("p2").at("value"), -0.0001);
  EXPECT_EQ(json::parse(content("result.json")).at("imus").at("imu0").at("noise").at("is_given"), true);

  writeFile(
      folder / "sensor.yaml",
      "sensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [1, 0, 0, 0,\n         0, 1, 0, 0,\n"
      "         0, 0, 1, 0,\n         0, 0, 0, 1]\nrate_hz: 20\nresolution: [752, 480]\ncamera_model: pinhole\n"
      "intrinsics: [461, 460, 370, 242] #fu, fv, cu, cv\ndistortion_model: radial-tangential\n"
      "distortion_coefficients: [-0.29, 0.08, 0.0002, 1.5e-05]\n");
  const CommandResult one_held = run({"--quiet", "--lenses", "cam1=" + file("sensor.yaml")});
  EXPECT_EQ(one_held.exit_code, 0) << one_held.errors;
  const json one = json::parse(content("result.json")).at("cameras");
  EXPECT_EQ(one.at("cam1").at("parameters").at("p2").at("value"), 1.5e-5);
  EXPECT_NE(one.at("cam0").at("parameters").at("fx").at("std"), 0);
  std::filesystem::remove(folder / "result.json");

  expectRefused(
      {"--quiet", "--lenses", file("sensor.yaml")},
      "--lenses sensor.yaml: the file has 1 lens for 2 cameras; write NAME=FILE for the lens of one camera");
  expectRefused({"--quiet", "--lenses", "cam7=" + file("sensor.yaml")},
                "--lenses cam7=sensor.yaml: there is no camera cam7; correct the name");
  expectRefused(
      {"--quiet", "--lenses", file("chain.yaml"), "--intrinsics", "fisheye"},
      "--lenses chain.yaml: the lens of cam0 is of the model opencv4, not fisheye; all cameras need one "
      "model, so drop --intrinsics");
  expectRefused({"--quiet", "--lenses", file("imu.yaml")},
                "imu.yaml:1: there is no camera; give Kalibr's camchain or EuRoC's sensor.yaml");
  writeFile(folder / "omni.yaml", "camera_model: omni\nintrinsics: [1, 2, 3, 4, 5]\n");
  expectRefused({"--quiet", "--lenses", "cam0=" + file("omni.yaml")},
                "omni.yaml:1: camera_model is \"omni\"; the models that can be read are pinhole or ds");
}

TEST_F(ImuStreamCommand, ErrorsOfAxesAreEstimated) {
  std::vector<std::string> words = imu();
  words.insert(words.end(), {"--imu-model", "scale-misalignment"});
  const CommandResult result = run(words);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("\n  acc xx "), std::string::npos) << result.output;
  const json model = json::parse(content("result.json")).at("imus").at("imu0").at("model");
  EXPECT_EQ(model.at("name"), "scale-misalignment");
  const json& axes = model.at("gyroscope_M");
  for (std::size_t i = 0; i < 9; ++i) {
    const double ideal = i % 4 == 0 ? 1 : 0;
    EXPECT_LT(std::abs(axes.at("value").at(i).get<double>() - ideal), 6 * axes.at("std").at(i).get<double>())
        << i;
  }
  EXPECT_EQ(model.at("accelerometer_M").at("value").at(1), 0);
  std::filesystem::remove(folder / "result.json");
  expectRefused(
      {"--imu-model", "scale-misalignment"},
      "--imu-model scale-misalignment: there is no IMU in motion; add --imu-stream NAME=FILE or drop this option");
  words.back() = "scale";
  expectRefused(
      words,
      "--imu-model scale: the models are calibrated, scale-misalignment and scale-misalignment-size-effect");
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
  expectCamerasAlone(
      words,
      "cam0_corners.csv: image 0 has no time; give corner files with a column t_ns, or photographs whose names "
      "are times in ns");
}

TEST_F(ImuStreamCommand, ARigAtRestIsRefused) {
  options.motion = SimulatedMotion::rest;
  writeStereoImuStream(simulateStereoImuStream(options), options, folder.path());
  std::vector<std::string> words = imu();
  words.insert(words.end(), {"--intrinsics", "opencv4", "--image-size", "752x480", "--output",
                             file("camchain.yaml"), "--report", file("report.html")});
  const CommandResult result = run(words);
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.output.find("\nverdict on the cameras: "), std::string::npos) << result.output;
  EXPECT_NE(result.output.find("\nverdict on the IMU: failed\n  * There are no values of the IMU. "),
            std::string::npos)
      << result.output;
  EXPECT_NE(result.output.find("not written, because the readings of the IMU were refused: "),
            std::string::npos);
  EXPECT_NE(content("report.html").find("There are no values of the IMU."), std::string::npos);
  EXPECT_TRUE(result.errors.starts_with(
                  "slom: imu0.csv: the angular velocities and the turns of the cameras correlate by ") &&
              result.errors.ends_with(
                  " at best, so their clocks cannot be compared; give images and readings of the same "
                  "motion, with quick turns about all axes\n"))
      << result.errors;
}

}  // namespace
}  // namespace slom::app::calib
