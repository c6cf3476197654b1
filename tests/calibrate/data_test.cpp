// Whole runs on real and simulated data, compared with OpenCV, the truth and independent fits.
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <slom/solve/instruction_set.hpp>

#include "calibrate/calibrate_command.hpp"

namespace slom::app::calib {
namespace {

using nlohmann::json;
using slom::testing::sharedDataPath;
using slom::testing::sourcePath;
using testing::TemporaryFolder;

json readJson(const std::filesystem::path& path) { return json::parse(slom::testing::readFile(path)); }

/// Calibrates and returns the JSON; the test fails when the command does.
json calibrated(std::vector<std::string> options) {
  const TemporaryFolder folder;
  options.insert(options.end(), {"--quiet", "--json", (folder / "result.json").string()});
  const auto result = testing::runCalibrate(options);
  EXPECT_EQ(result.errors, "");
  EXPECT_EQ(result.output, "");
  EXPECT_EQ(result.exit_code, 0);
  return result.exit_code == 0 ? readJson(folder / "result.json") : json();
}

std::vector<std::string> stereo(const std::filesystem::path& folder, const std::string& model) {
  return {"--camera",     "left=" + (folder / "left_corners.csv").string(),
          "--camera",     "right=" + (folder / "right_corners.csv").string(),
          "--intrinsics", model};
}

/// Runs tests/calibrate_reference/opencv_stereo.py. Exit code 3 means that OpenCV is missing.
testing::CommandResult runReference(std::vector<std::string> options) {
  options.insert(options.begin(),
                 {"/usr/bin/python3", sourcePath("tests/calibrate_reference/opencv_stereo.py").string()});
  return slom::testing::runCommand(options);
}

void expectNoWorseThanOpenCV(const std::filesystem::path& folder, const std::string& model) {
  std::vector<std::string> options{(folder / "left_corners.csv").string(),
                                   (folder / "right_corners.csv").string()};
  if (model == "opencv4") options.push_back("--fix-k3");
  const auto reference = runReference(options);
  if (reference.exit_code == 3) GTEST_SKIP() << reference.errors;
  ASSERT_EQ(reference.exit_code, 0) << reference.errors;
  const json theirs = json::parse(reference.output), ours = calibrated(stereo(folder, model));
  for (const std::string camera : {"left", "right"}) {
    const double limit = theirs["rms_px"][camera];
    EXPECT_LT(ours["rms_px"][camera], 1.005 * limit) << camera;
    EXPECT_GT(ours["rms_px"][camera], 0.995 * limit) << camera << ": too good to be the same problem";
    for (const auto& [name, value] : theirs["cameras"][camera].items()) {
      if (model == "opencv4" && name == "k3") continue;
      const json& p = ours["cameras"][camera]["parameters"][name];
      EXPECT_NEAR(p["value"], value.get<double>(), 0.05 * p["std"].get<double>()) << camera << " " << name;
    }
  }
}

TEST(CalibrateData, BundledStereoReachesOpenCVWithOpencv4) {
  expectNoWorseThanOpenCV(sourcePath("data/opencv_stereo"), "opencv4");
}
TEST(CalibrateData, BundledStereoReachesOpenCVWithOpencv5) {
  expectNoWorseThanOpenCV(sourcePath("data/opencv_stereo"), "opencv5");
}
TEST(CalibrateData, SharedStereoReachesOpenCVWithOpencv4) {
  SLOM_SKIP_WITHOUT_SHARED_DATA("opencv_stereo");
  expectNoWorseThanOpenCV(sharedDataPath("opencv_stereo"), "opencv4");
}
TEST(CalibrateData, SharedStereoReachesOpenCVWithOpencv5) {
  SLOM_SKIP_WITHOUT_SHARED_DATA("opencv_stereo");
  expectNoWorseThanOpenCV(sharedDataPath("opencv_stereo"), "opencv5");
}

TEST(CalibrateData, BundledSimulationFindsItsTruth) {
  const auto folder = sourcePath("data/simulated_stereo_imu");
  std::vector<std::string> options = stereo(folder, "opencv5");
  options.insert(options.end(), {"--imu", (folder / "imu.csv").string()});
  const json result = calibrated(options), truth = readJson(folder / "truth.json");
  constexpr double sigmas = 4;
  for (const std::string camera : {"left", "right"}) {
    for (const auto& [name, p] : result["cameras"][camera]["parameters"].items()) {
      const double expected = truth["cameras"][camera]["parameters"][name]["value"];
      EXPECT_NEAR(p["value"], expected, sigmas * p["std"].get<double>()) << camera << " " << name;
    }
    const json& pose = result["cameras"][camera]["pose_from_left"];
    const json& true_pose = truth["cameras"][camera]["pose_from_left"];
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(pose["translation"][i], true_pose["translation"][i].get<double>(),
                  sigmas * pose["std"][i].get<double>() + 1e-12);
    }
    for (int i = 0; i < 9; ++i) {
      EXPECT_NEAR(pose["rotation"][i], true_pose["rotation"][i].get<double>(),
                  sigmas * pose["std"][4].get<double>() + 1e-12);
    }
  }
  const json &imu = result["imu"], &true_imu = truth["imu"];
  EXPECT_NEAR(imu["gravity"], true_imu["gravity"].get<double>(), sigmas * imu["gravity_std"].get<double>());
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(imu["acc_bias"][i], true_imu["acc_bias"][i].get<double>(),
                sigmas * imu["acc_bias_std"][i].get<double>());
  }
  EXPECT_NEAR(result["chi2_per_dof"], 1, 0.1);
  EXPECT_EQ(result["measurements"], 2 * (900 + 924) + 3 * 10);
  EXPECT_EQ(result["unknowns"], 18 + 6 + 12 * 6 + 7);
}

/// The expected figures come from an independent fit of the same model by SciPy's least_squares from the
/// start values of the data set's initial_guess.csv: RSS 7594.147610, values equal to 1e-5 standard
/// deviations.
TEST(CalibrateData, JustinEqualsAnIndependentFit) {
  SLOM_SKIP_WITHOUT_SHARED_DATA("justin");
  const auto folder = sharedDataPath("justin");
  std::vector<std::string> options = stereo(folder, "radial1");
  options.insert(options.end(), {"--imu", (folder / "imu.csv").string(), "--imu-reads", "gravity"});
  const json result = calibrated(options);
  EXPECT_EQ(result["measurements"], 2 * 3352 + 3 * 11);
  EXPECT_EQ(result["unknowns"], 129);
  EXPECT_NEAR(result["rss"], 7594.147610, 1e-4);
  const auto expect = [&](const json& p, double value, double std) {
    EXPECT_NEAR(p["value"], value, 1e-4 * std);
    EXPECT_NEAR(p["std"], std, 1e-5 * std);
  };
  const json &left = result["cameras"]["left"]["parameters"],
             &right = result["cameras"]["right"]["parameters"];
  expect(left["f"], 1872.7169469, 0.579881006);
  expect(left["cx"], 858.2617352, 0.662163800);
  expect(left["cy"], 618.3835691, 0.758251114);
  expect(left["k1"], -0.08906409539, 0.000645991926);
  expect(right["f"], 1862.4098218, 0.567057432);
  expect(right["k1"], -0.09840224341, 0.000686203540);
  const json& pose = result["cameras"]["right"]["pose_from_left"];
  EXPECT_NEAR(pose["translation"][0], -0.20014833, 2e-8);
  EXPECT_NEAR(pose["std"][2], 4.26559759e-04, 1e-9);
  EXPECT_NEAR(result["imu"]["gravity"], -9.65320823, 1e-5);
  EXPECT_NEAR(result["imu"]["gravity_std"], 0.2576883, 1e-6);
  EXPECT_NEAR(result["imu"]["acc_bias"][2], -0.147088451, 1e-5);
}

TEST(CalibrateData, JustinWithGravityFixedKeepsTheSignOfTheData) {
  SLOM_SKIP_WITHOUT_SHARED_DATA("justin");
  const auto folder = sharedDataPath("justin");
  std::vector<std::string> options = stereo(folder, "radial1");
  options.insert(options.end(), {"--imu", (folder / "imu.csv").string(), "--imu-reads", "gravity", "--fix",
                                 "gravity=9.81", "--fix", "acc_bias"});
  const json result = calibrated(options);
  EXPECT_EQ(result["imu"]["gravity"], -9.81);
  EXPECT_EQ(result["imu"]["gravity_std"], 0);
  EXPECT_EQ(result["imu"]["acc_bias"], json({0.0, 0.0, 0.0}));
  EXPECT_EQ(result["unknowns"], 125);
  EXPECT_LT(result["rms_acc"], 0.05);
}

TEST(CalibrateData, JustinHasThePrecisionThatTheDocumentationShows) {
  SLOM_SKIP_WITHOUT_SHARED_DATA("justin");
  const auto folder = sharedDataPath("justin");
  std::vector<std::string> options = stereo(folder, "radial1");
  options.insert(options.end(), {"--imu", (folder / "imu.csv").string(), "--imu-reads", "gravity"});
  const std::string report = testing::runCalibrate(options).output;
  const std::string page = slom::testing::readFile(sourcePath("docs/calibrate/refine.md"));
  const std::size_t begin = report.find("  largest std"), end = report.find("\n\n", begin);
  ASSERT_NE(begin, std::string::npos);
  EXPECT_NE(page.find("```text\n" + report.substr(begin, end - begin) + "\n```"), std::string::npos)
      << report.substr(begin, end - begin);
}

TEST(CalibrateData, MonoIsTheLeftCameraOfJustin) {
  SLOM_SKIP_WITHOUT_SHARED_DATA("mono");
  const json result = calibrated(
      {"--camera", "cam=" + sharedDataPath("mono/corners.csv").string(), "--intrinsics", "radial1"});
  EXPECT_EQ(result["measurements"], 3326);
  EXPECT_EQ(result["unknowns"], 112);
  // The same problem in 1 / (1 + k r^2) has 4035.56; 1 + k1 r^2 bends a little differently.
  EXPECT_NEAR(result["rss"], 4101, 5);
  EXPECT_NEAR(result["cameras"]["cam"]["parameters"]["f"]["value"], 1872.6, 3);
  EXPECT_TRUE(result["imu"].is_null());
  EXPECT_TRUE(result["rms_acc"].is_null());
  EXPECT_TRUE(result["cameras"]["cam"].contains("pose_from_cam"));
}

TEST(CalibrateData, JsonHoldsTheKeysThatAreDocumented) {
  const auto folder = sourcePath("data/simulated_stereo_imu");
  std::vector<std::string> options = stereo(folder, "opencv5");
  options.insert(options.end(), {"--imu", (folder / "imu.csv").string()});
  const json result = calibrated(options);
  for (const std::string key : {"converged", "stop_reason", "iterations", "measurements", "unknowns",
                                "redundancy", "rss", "chi2_per_dof", "rms_px", "rms_acc", "cameras", "imu"}) {
    EXPECT_TRUE(result.contains(key)) << key;
  }
  EXPECT_EQ(result["converged"], true);
  const json& right = result["cameras"]["right"];
  EXPECT_EQ(right["model"], "opencv5");
  for (const std::string key : {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3"}) {
    EXPECT_GT(right["parameters"][key]["std"], 0) << key;
  }
  EXPECT_EQ(right["pose_from_left"]["rotation"].size(), 9u);
  EXPECT_EQ(right["pose_from_left"]["translation"].size(), 3u);
  EXPECT_EQ(right["pose_from_left"]["std"].size(), 6u);
  EXPECT_EQ(result["cameras"]["left"]["pose_from_left"]["std"], json({0.0, 0.0, 0.0, 0.0, 0.0, 0.0}));
  EXPECT_EQ(result["imu"]["rotation_from_left"].size(), 9u);
  EXPECT_EQ(result["imu"]["std"].size(), 3u);
  EXPECT_EQ(result["imu"]["acc_bias"].size(), 3u);
  EXPECT_TRUE(result["imu"]["gravity"].is_number());
}

/// The right camera's clock is late by 1.5 of the 100 ms between images.
TEST(CalibrateData, JsonSaysHowTimeStampsWerePaired) {
  const TemporaryFolder folder;
  const auto data = sourcePath("data/opencv_stereo");
  std::vector<std::string> options;
  for (const std::string name : {"left", "right"}) {
    std::istringstream lines(slom::testing::readFile(data / (name + "_corners.csv")));
    std::string changed;
    for (std::string line; std::getline(lines, line); changed += line + "\n") {
      const std::size_t comma = line.find(',');
      const bool is_row = line[0] >= '0' && line[0] <= '9';
      if (is_row)
        line = std::to_string(1'700'000'000'000'000'000 + 100'000'000LL * std::stoi(line) +
                              (name == "right" ? 1'500'000 : 0)) +
               line.substr(comma);
    }
    slom::testing::writeFile(folder / (name + ".csv"), changed);
    options.insert(options.end(), {"--camera", name + "=" + (folder / (name + ".csv")).string()});
  }
  const json stamps = calibrated(options)["time_stamps"];
  EXPECT_EQ(stamps["largest_difference"], 1'500'000);
  EXPECT_EQ(stamps["spacing"], 100'000'000);
  EXPECT_GT(stamps["paired_images"], 9);
  const json numbered = calibrated(stereo(data, "opencv5"));
  EXPECT_TRUE(numbered["time_stamps"].is_null());
  EXPECT_EQ(numbered["kernels"], slom::instructionSet());
}

/// As the other commands: nothing but the JSON is on standard output, and there is no file of that name.
TEST(CalibrateData, WritesJsonToStandardOutput) {
  std::vector<std::string> options = stereo(sourcePath("data/simulated_stereo_imu"), "opencv4");
  options.insert(options.end(), {"--json", "-"});
  const auto result = testing::runCalibrate(options);
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_TRUE(json::parse(result.output)["converged"].get<bool>());
  EXPECT_FALSE(std::filesystem::exists("-"));
}

TEST(CalibrateData, OpenCVReadsTheYaml) {
  const TemporaryFolder folder;
  const auto data = sourcePath("data/simulated_stereo_imu");
  std::vector<std::string> options = stereo(data, "opencv4");
  const std::string yaml_file = (folder / "calibration.yaml").string();
  options.insert(options.end(), {"--imu", (data / "imu.csv").string(), "--output", yaml_file, "--json",
                                 (folder / "result.json").string(), "--quiet"});
  ASSERT_EQ(testing::runCalibrate(options).exit_code, 0);
  const auto reference = runReference({"--yaml", yaml_file});
  if (reference.exit_code == 3) GTEST_SKIP() << reference.errors;
  ASSERT_EQ(reference.exit_code, 0) << reference.errors;
  const json yaml = json::parse(reference.output)["yaml"], result = readJson(folder / "result.json");
  EXPECT_EQ(yaml["reference"], "left");
  for (const std::string name : {"left", "right"}) {
    const json &read = yaml["cameras"][name], &p = result["cameras"][name]["parameters"];
    const json& pose = result["cameras"][name]["pose_from_left"];
    EXPECT_EQ(read["model"], "opencv4");
    EXPECT_EQ(read["camera_matrix"], json({{p["fx"]["value"], 0.0, p["cx"]["value"]},
                                           {0.0, p["fy"]["value"], p["cy"]["value"]},
                                           {0.0, 0.0, 1.0}}));
    EXPECT_EQ(read["distortion_coefficients"],
              json({{p["k1"]["value"], p["k2"]["value"], p["p1"]["value"], p["p2"]["value"], 0.0}}));
    for (int i = 0; i < 9; ++i) EXPECT_EQ(read["rotation_from_left"][i / 3][i % 3], pose["rotation"][i]);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(read["translation_from_left"][i][0], pose["translation"][i]);
  }
  EXPECT_EQ(yaml["imu"]["gravity"], result["imu"]["gravity"]);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(yaml["imu"]["acc_bias"][i][0], result["imu"]["acc_bias"][i]);
}

TEST(CalibrateParts, AFixedParameterIsTheModelWithoutIt) {
  const auto folder = sourcePath("data/opencv_stereo");
  auto options = stereo(folder, "opencv5");
  options.insert(options.end(), {"--fix", "k3"});
  const json fixed = calibrated(options), without = calibrated(stereo(folder, "opencv4"));
  EXPECT_EQ(fixed["unknowns"], without["unknowns"]);
  EXPECT_NEAR(fixed["rss"], without["rss"].get<double>(), 1e-6 * without["rss"].get<double>());
  for (const std::string camera : {"left", "right"}) {
    EXPECT_EQ(fixed["cameras"][camera]["parameters"]["k3"]["value"], 0);
    EXPECT_EQ(fixed["cameras"][camera]["parameters"]["k3"]["std"], 0);
    for (const auto& [name, p] : without["cameras"][camera]["parameters"].items()) {
      const json& own = fixed["cameras"][camera]["parameters"][name];
      const double std = p["std"];
      EXPECT_NEAR(own["value"], p["value"].get<double>(), 1e-4 * std) << camera << " " << name;
      EXPECT_NEAR(own["std"], std, 1e-4 * std) << camera << " " << name;
    }
  }
  EXPECT_TRUE(fixed["active_bounds"].empty());
}

TEST(CalibrateParts, ABoundHoldsOneCameraAlone) {
  const auto folder = sourcePath("data/opencv_stereo");
  const json free = calibrated(stereo(folder, "opencv5"));
  const double k3 = free["cameras"]["left"]["parameters"]["k3"]["value"];
  const double limit = k3 - 0.01;
  auto options = stereo(folder, "opencv5");
  options.insert(options.end(), {"--bound", "left.k3=-10," + std::to_string(limit)});
  const json bounded = calibrated(options);
  EXPECT_NEAR(bounded["cameras"]["left"]["parameters"]["k3"]["value"], limit, 1e-6);
  EXPECT_EQ(bounded["cameras"]["left"]["parameters"]["k3"]["std"], 0);
  EXPECT_GT(bounded["cameras"]["right"]["parameters"]["k3"]["std"], 0);
  EXPECT_GT(bounded["rss"], free["rss"]);
  EXPECT_EQ(bounded["unknowns"], free["unknowns"].get<int>() - 1);
  ASSERT_EQ(bounded["active_bounds"].size(), 1u);
  EXPECT_EQ(bounded["active_bounds"][0].get<std::string>().substr(0, 30), "left.k3 is at its upper bound ");
  // Far enough away it does nothing.
  options.back() = "left.k3=-10,10";
  const json same = calibrated(options);
  EXPECT_NEAR(same["rss"], free["rss"].get<double>(), 1e-9 * free["rss"].get<double>());
  EXPECT_TRUE(same["active_bounds"].empty());
}

}  // namespace
}  // namespace slom::app::calib
