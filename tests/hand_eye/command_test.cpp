// `slom hand-eye` as a user runs it.
#include <gtest/gtest.h>

#include "hand_eye/hand_eye_command.hpp"

namespace slom::testing {
namespace {

using Json = nlohmann::json;

/// Files of a simulated hand.
struct Files {
  std::string hand, camera;
  explicit Files(const SimulatedHand& truth = {}) {
    const SimulatedStreams streams = simulated(truth);
    hand = csvOf(streams.hand);
    camera = csvOf(streams.camera);
  }
};

TEST(HandEyeCommand, SaysWhatTheFilesWereTakenAs) {
  const TemporaryFolder folder;
  SimulatedStreams streams = simulated({});
  for (auto& pose : streams.camera.poses) pose.pose = pose.pose.inverse();
  const std::string report =
      runHandEye(folder, csvOf(streams.hand), csvOf(streams.camera), {"--invert-camera"}).output;
  for (const std::string line : {"\n          taken as base_T_hand: poses of the hand in the base\n",
                                 "\n          taken as camera_T_target: poses of the target in the camera\n",
                                 "\n  p_hand = R p_camera + t\n", "\n  p_base = R p_target + t\n"})
    EXPECT_NE(report.find(line), std::string::npos) << line << "\nis not in\n" << report;
}

TEST(HandEyeCommand, ReportsValuesAndWritesJson) {
  const TemporaryFolder folder;
  const SimulatedHand truth;
  const Files files(truth);
  const CommandResult result = runHandEye(folder, files.hand, files.camera, {"--json", "DIR/result.json"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(result.errors, "");
  EXPECT_NE(result.output.find("  hand    hand.csv: 2000 poses in 20.0 s, 100.0 per second\n"),
            std::string::npos);
  EXPECT_NE(result.output.find("  t_hand = t_camera + offset\n"), std::string::npos);
  EXPECT_NE(result.output.find("\nConverged; the motion determines everything.\n"), std::string::npos);
  EXPECT_TRUE(result.output.ends_with("\nwritten: result.json\n")) << result.output;
  const Json json = Json::parse(readFile(folder / "result.json"));
  EXPECT_EQ(json["converged"], true);
  EXPECT_EQ(json["undetermined"].size(), 0u);
  EXPECT_EQ(json["hand_T_camera"]["rotation"].size(), 9u);
  for (int k = 0; k < 3; ++k) {
    const double std = json["hand_T_camera"]["std"][std::size_t(k)];
    EXPECT_NEAR(double(json["hand_T_camera"]["translation"][std::size_t(k)]), truth.hand_T_camera.pos[k],
                5 * std);
  }
  const double offset = json["time_offset_s"]["value"], std = json["time_offset_s"]["std"];
  EXPECT_NEAR(offset, truth.offset, 5 * std);
  EXPECT_EQ(json["scale"]["estimated"], false);
  EXPECT_EQ(json["base_T_target"]["std_clustered"].size(), 6u);
}

TEST(HandEyeCommand, JsonToStandardOutput) {
  const TemporaryFolder folder;
  const Files files;
  const CommandResult result =
      runHandEye(folder, files.hand, files.camera, {"--json", "-", "--motions", "0.5", "--scale"});
  const Json json = Json::parse(result.output);
  EXPECT_TRUE(json["base_T_target"].is_null());
  EXPECT_EQ(json["scale"]["estimated"], true);
  EXPECT_GT(json["motions"], 300);
  EXPECT_NE(result.errors.find("hand-eye calibration\n"), std::string::npos);
}

TEST(HandEyeCommand, InverseFilesAreTurned) {
  const TemporaryFolder folder;
  SimulatedStreams streams = simulated({});
  const std::string hand = csvOf(streams.hand);
  for (auto& pose : streams.camera.poses) pose.pose = pose.pose.inverse();
  const std::string camera = csvOf(streams.camera);
  EXPECT_EQ(runHandEye(folder, hand, camera, {"--invert-camera", "--quiet"}).exit_code, 0);
  const CommandResult wrong = runHandEye(folder, hand, camera, {"--quiet"});
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_NE(wrong.errors.find("pass --invert-camera"), std::string::npos) << wrong.errors;
}

/// Returns the text of a file whose quaternions are w, x, y, z below a header that says x, y, z, w.
std::string wFirst(SimulatedStreams streams, bool is_hand) {
  PoseStream& stream = is_hand ? streams.hand : streams.camera;
  for (auto& pose : stream.poses) {
    const auto q = pose.pose.orient;
    pose.pose.orient = calibration::SO3(q.z(), q.w(), q.x(), q.y());
  }
  return csvOf(stream);
}

TEST(HandEyeCommand, TheTrueCauseOfAMisfitIsNamed) {
  const SimulatedStreams streams = simulated({});
  const std::string hand = csvOf(streams.hand), camera = csvOf(streams.camera),
                    hand_w = wFirst(streams, true), camera_w = wFirst(streams, false);
  const auto expectAdvice = [](const std::string& of_hand, const std::string& of_camera,
                               std::vector<std::string> options, const std::string& end) {
    const TemporaryFolder folder;
    options.push_back("--quiet");
    const CommandResult result = runHandEye(folder, of_hand, of_camera, options);
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_TRUE(result.errors.ends_with(" degrees; " + end + "\n")) << result.errors << "is not\n" << end;
  };
  const std::string of_camera = "the quaternions of camera.csv in the order w, x, y, z",
                    of_hand = "the quaternions of hand.csv in the order w, x, y, z",
                    better = " agree far better, so name its columns qw,qx,qy,qz in a header";
  expectAdvice(hand, camera, {"--invert-camera"},
               "the poses of camera.csv as the file has them agree far better, so do not invert them: drop "
               "--invert-camera");
  expectAdvice(
      hand, camera, {"--invert-hand"},
      "the poses of hand.csv as the file has them agree far better, so do not invert them: drop --invert-hand");
  expectAdvice(hand, camera_w, {}, of_camera + better);
  expectAdvice(hand_w, camera, {}, of_hand + better);
  expectAdvice(hand_w, camera_w, {}, of_hand + " and " + of_camera + better);
  expectAdvice(hand, camera_w, {"--invert-camera"},
               of_camera + " and the poses of camera.csv as the file has them" + better +
                   ", and do not invert them: drop --invert-camera");
  expectAdvice(hand_w, camera, {"--invert-camera"},
               of_hand + " and the poses of camera.csv as the file has them" + better +
                   ", and do not invert them: drop --invert-camera");
}

/// AX = XB is symmetric: only the names of the files can tell.
TEST(HandEyeCommand, ExchangedFilesGiveTheInverse) {
  const TemporaryFolder folder;
  SimulatedHand truth;
  const Files files(truth);
  const CommandResult result = runHandEye(folder, files.camera, files.hand, {"--json", "DIR/result.json"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const Json json = Json::parse(readFile(folder / "result.json"));
  const calibration::SE3 camera_T_hand = truth.hand_T_camera.inverse();
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(double(json["hand_T_camera"]["translation"][std::size_t(k)]), camera_T_hand.pos[k], 0.01);
  EXPECT_EQ(json["warnings"].size(), 0u);  // the files are named hand.csv and camera.csv
  writeFile(folder / "cam0_poses.csv", files.camera);
  writeFile(folder / "robot.csv", files.hand);
  const auto warningsOf = [&](const std::string& first, const std::string& second) {
    const CommandResult again = runCommand({commandPath().string(), "hand-eye", (folder / first).string(),
                                            (folder / second).string(), "--json", "-", "--quiet"});
    return replaced(Json::parse(again.output)["warnings"].dump(), folder.path().string() + "/", "");
  };
  EXPECT_EQ(warningsOf("robot.csv", "cam0_poses.csv"), "[]");
  EXPECT_EQ(
      warningsOf("cam0_poses.csv", "robot.csv"),
      "[\"by their names, cam0_poses.csv is of a camera and robot.csv of a hand, but they were given the other way "
      "round; the poses fit either way, with inverse transforms, so give the file of the hand first\"]");
}

TEST(HandEyeCommand, WhatIsFreeEndsWithOne) {
  const TemporaryFolder folder;
  SimulatedHand truth;
  truth.motion = HandMotion::one_axis;
  const Files files(truth);
  const CommandResult result = runHandEye(folder, files.hand, files.camera, {"--json", "DIR/result.json"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_TRUE(result.errors.starts_with(
      "slom: the translation of the camera along (0.000, 0.000, 1.000) of the hand is not determined, because the hand "
      "turns about (0.000, 0.000, 1.000) only ("))
      << result.errors;
  EXPECT_TRUE(result.errors.ends_with("; turn it by 20 degrees or more about another axis, too\n"))
      << result.errors;
  const Json json = Json::parse(readFile(folder / "result.json"));
  EXPECT_EQ(json["undetermined"].size(), 1u);
  EXPECT_TRUE(json["hand_T_camera"]["std"][2].is_null());
  EXPECT_TRUE(json["hand_T_camera"]["std"][0].is_number());
}

TEST(HandEyeCommand, PairsNeedNoTimes) {
  const TemporaryFolder folder;
  SimulatedHand truth;
  truth.hand_rate = truth.camera_rate = 2;
  truth.offset = 0;
  SimulatedStreams streams = simulated(truth);
  for (std::size_t i = 0; i < streams.hand.poses.size(); ++i)
    streams.hand.poses[i].pose = handAt(truth, streams.camera.poses[i].t_s);
  const CommandResult result = runHandEye(folder, csvOf(streams.hand, false), csvOf(streams.camera, false),
                                          {"--pairs", "--json", "DIR/r.json"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(result.output.find("time offset"), std::string::npos);
  EXPECT_EQ(Json::parse(readFile(folder / "r.json"))["rows"], 40);
}

TEST(HandEyeCommand, BadFilesAreRefused) {
  const Files files;
  const std::string header = "t_s,x_m,y_m,z_m,qx,qy,qz,qw\n";
  expectRefused(files.hand, header + "1,2,3,4,0,0,0,one\n",
                "camera.csv:2: qw is \"one\"; write a number there, or remove the row");
  expectRefused(
      header + "2,0,0,0,0,0,0,1\n1,0,0,0,0,0,0,1\n3,0,0,0,0,0,0,1\n", files.camera,
      "hand.csv:3: the time 1.000000000 s is 1 s before the one above; sort the rows by time, or remove those of "
      "a clock that was set back");
  expectRefused(
      "x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,1\n0,0,0,0,0,0,1\n0,0,0,0,0,0,1\n", files.camera,
      "hand.csv: there is no column of times; add t_s, or pass --pairs if the rows of both files belong together");
}

TEST(HandEyeCommand, BadOptionsAreRefused) {
  const Files files;
  const auto refused = [&](const std::string& sentence, const std::vector<std::string>& options) {
    expectRefused(files.hand, files.camera, sentence, options);
  };
  refused("--offset soon: give t_hand - t_camera in seconds", {"--offset", "soon"});
  refused("--motions 0: give the length of a motion in seconds, above 0", {"--motions", "0"});
  refused("--outlier-sigmas 1: give a number of standard deviations from 2 on", {"--outlier-sigmas", "1"});
  refused("--no-offset: contradicts --offset; keep one of them", {"--no-offset", "--offset", "1"});
  refused("--pairs: contradicts --motions; keep one of them", {"--pairs", "--motions", "1"});
  refused("--pairs: contradicts --offset; keep one of them", {"--pairs", "--offset", "1"});
  refused(
      "hand.csv has 2000 poses and camera.csv has 400 poses; give a row in both for each moment, or compare them by time",
      {"--pairs"});
}

}  // namespace
}  // namespace slom::testing
