// Streams of poses from files, and everything that may be wrong with them.
#include <cmath>
#include <fstream>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "calibration/hand_eye_streams.hpp"
#include "support/message_of.hpp"
#include "support/replaced.hpp"
#include "support/temporary_folder.hpp"

namespace slom::testing {
namespace {

using calibration::HandEyeSettings;
using calibration::readPoseStream;

constexpr const char* header = "t_s,x_m,y_m,z_m,qx,qy,qz,qw\n";

PoseStream read(const std::string& text) {
  const TemporaryFolder folder;
  std::ofstream(folder / "poses.csv", std::ios::binary) << text;
  return readPoseStream((folder / "poses.csv").string());
}

std::string faultOf(const std::string& text) {
  const TemporaryFolder folder;
  std::ofstream(folder / "poses.csv", std::ios::binary) << text;
  const std::string file = (folder / "poses.csv").string();
  return replaced(messageOf([&] { readPoseStream(file); }), folder.path().string() + "/", "");
}

TEST(PoseFiles, AllHeadersGiveTheSame) {
  const std::string texts[] = {
      "t_s,x_m,y_m,z_m,qx,qy,qz,qw\n1.5,1,2,3,0,0,0.6,0.8\n",
      "# a comment\n\nqw;qx;qy;qz;x;y;z;t\n0.8;0;0;0.6;1;2;3;1.5\n",
      "t_ns,x_m,y_m,z_m,qx,qy,qz,qw,valid\r\n1500000000,1,2,3,0,0,0.6,0.8,1\r\n",
      "timestamp_us,x,y,z,qx,qy,qz,qw\n1500000,1,2,3,0,0,0.6,0.8\n",
      "time [ms],x,y,z,qx,qy,qz,qw\n1500.0,1,2,3,0,0,0.6,0.8\n",
      "# timestamp tx ty tz qx qy qz qw\n1.5 1 2 3 0 0 0.6 0.8\n",
      "timestamp tx ty tz qx qy qz qw\n1.5\t1  2 3 0 0 0.6 0.8",
  };
  for (const std::string& text : texts) {
    const PoseStream stream = read(text);
    ASSERT_EQ(stream.poses.size(), 1u) << text;
    EXPECT_TRUE(stream.has_times);
    EXPECT_EQ(stream.poses[0].t_s, 1.5) << text;
    EXPECT_EQ(stream.poses[0].pose.pos, vec3(1., 2., 3.)) << text;
    EXPECT_NEAR(stream.poses[0].pose.orient.z(), 0.6, 1e-15) << text;
    EXPECT_NEAR(stream.poses[0].pose.orient.w(), 0.8, 1e-15) << text;
  }
}

TEST(PoseFiles, TimesOfAnotherUnitThanSecondsAreNamed) {
  const std::string pose = " 1 2 3 0 0 0 1\n", other = ",1,2,3,0,0,0,1\n";
  EXPECT_EQ(
      faultOf("1403715273262142" + pose + "1403715273312142" + pose),
      "[slom.calibration.bad-file] poses.csv: poses follow each other by 5e+04 s if their times are seconds, as if "
      "they were microseconds; name their column t_us in a header");
  EXPECT_EQ(
      faultOf("timestamp,x,y,z,qx,qy,qz,qw\n1403715273262142976" + other + "1403715273312142976" + other),
      "[slom.calibration.bad-file] poses.csv: poses follow each other by 5e+07 s if their times are seconds, as if "
      "they were nanoseconds; name their column t_ns in a header");
  EXPECT_EQ(read("t_s,x,y,z,qx,qy,qz,qw\n0" + other + "50000" + other).poses[1].t_s, 50000);
}

TEST(PoseFiles, WithoutTimesPosesAreCounted) {
  const PoseStream stream = read("x,y,z,qx,qy,qz,qw\n1,2,3,0,0,0,1\n1,2,4,0,0,0,1\n");
  EXPECT_FALSE(stream.has_times);
  EXPECT_EQ(stream.poses[1].t_s, 1);
  EXPECT_EQ(stream.poses[1].line, 3);
}

TEST(PoseFiles, Faults) {
  EXPECT_EQ(
      faultOf(""),
      "[slom.calibration.bad-file] poses.csv: there are no poses; write \"t_s,x_m,y_m,z_m,qx,qy,qz,qw\" and one row for each pose");
  EXPECT_EQ(faultOf(header), faultOf(""));
  EXPECT_EQ(
      faultOf("t_s,x_m,y_m,qx,qy,qz,qw\n"),
      "[slom.calibration.bad-file] poses.csv:1: the header is \"t_s,x_m,y_m,qx,qy,qz,qw\" and lacks the column z_m; write "
      "\"t_s,x_m,y_m,z_m,qx,qy,qz,qw\"");
  EXPECT_EQ(faultOf("t_s,t_ns,x_m,y_m,z_m,qx,qy,qz,qw\n"),
            "[slom.calibration.bad-file] poses.csv:1: t_s and t_ns name the same column; keep one of them");
  EXPECT_EQ(
      faultOf("1,2,3,4,0,0,0,1\n"),
      "[slom.calibration.bad-file] poses.csv:1: there is no header, and numbers alone do not say what they are; put "
      "\"t_s,x_m,y_m,z_m,qx,qy,qz,qw\" above, or write a trajectory of TUM (t x y z qx qy qz qw, separated by "
      "blanks)");
  EXPECT_EQ(
      faultOf(header + std::string("1,2,3,4,0,0,1\n")),
      "[slom.calibration.bad-file] poses.csv:2: the row has 7 fields instead of 8; write \"t_s,x_m,y_m,z_m,qx,qy,qz,qw\"");
  EXPECT_EQ(faultOf(header + std::string(",2,3,4,0,0,0,1\n")),
            "[slom.calibration.bad-file] poses.csv:2: t_s is \"\"; write a number there, or remove the row");
  EXPECT_EQ(
      faultOf(header + std::string("1,nan,3,4,0,0,0,1\n")),
      "[slom.calibration.bad-file] poses.csv:2: x_m is \"nan\"; write a finite number there, or remove the row");
  EXPECT_EQ(
      faultOf(header + std::string("1,2e9,3,4,0,0,0,1\n")),
      "[slom.calibration.bad-file] poses.csv:2: x_m is \"2e9\"; write metres, at most 1e7, there, or remove the row");
  EXPECT_EQ(
      faultOf(header + std::string("1,2,3,4,0,0,0,0.5\n")),
      "[slom.calibration.bad-file] poses.csv:2: the quaternion has the length 0.5 instead of 1; correct it, or remove the row");
}

/// Streams of a good recording, to be spoiled.
struct Spoiled {
  SimulatedStreams streams = simulated({});
  HandEyeSettings settings;

  std::string message() const {
    return messageOf([&] { calibration::handEye(streams.hand, streams.camera, settings); });
  }
};

TEST(PoseStreams, TimesThatGoBackAreRefused) {
  Spoiled data;
  data.streams.camera.poses[6].t_s = 0.375;
  data.streams.camera.poses[7].t_s = 0.25;
  EXPECT_EQ(
      data.message(),
      "[slom.calibration.bad-stream] camera.csv:9: the time 0.250000000 s is 0.125 s before the one above; sort the "
      "rows by time, or remove those of a clock that was set back");
}

TEST(PoseStreams, StreamsThatCannotBeUsedAreRefused) {
  Spoiled few;
  few.streams.hand.poses.resize(2);
  EXPECT_EQ(
      few.message(),
      "[slom.calibration.bad-stream] hand.csv: there are 2 poses; record at least 3, with turns about two axes");
  Spoiled infinite;
  infinite.streams.camera.poses[4].pose.pos[1] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(infinite.message(),
            "[slom.calibration.bad-stream] camera.csv:6: the pose is not finite; leave it out");
  Spoiled standing;
  for (auto& pose : standing.streams.hand.poses) pose.t_s = 4;
  EXPECT_EQ(
      standing.message(),
      "[slom.calibration.bad-stream] hand.csv: all poses have the same time; write the time of each, or pass pairs of poses");
}

TEST(PoseStreams, ThatDoNotBelongTogetherAreRefused) {
  Spoiled unequal;
  unequal.settings.pairs = true;
  EXPECT_EQ(
      unequal.message(),
      "[slom.calibration.bad-stream] hand.csv has 2000 poses and camera.csv has 400 poses; give a row in both for each moment, or compare them by time");
  Spoiled timeless;
  timeless.streams.camera.has_times = false;
  EXPECT_EQ(
      timeless.message(),
      "[slom.calibration.bad-stream] camera.csv: there is no column of times; add t_s, or pass pairs of poses");
  Spoiled motion;
  motion.settings.motion_s = 0;
  EXPECT_EQ(motion.message(),
            "[slom.calibration.bad-settings] HandEyeSettings::motion_s is 0; give seconds above 0");
  Spoiled sigmas;
  sigmas.settings.outlier_sigmas = 1;
  EXPECT_EQ(sigmas.message(),
            "[slom.calibration.bad-settings] HandEyeSettings::outlier_sigmas is 1; give a number from 2 on");
  Spoiled offset;
  offset.settings.time_offset_s = std::nan("");
  EXPECT_EQ(offset.message(),
            "[slom.calibration.bad-settings] HandEyeSettings::time_offset_s is nan; give seconds");
}

TEST(PoseStreams, WithoutCommonTimeThereIsNothingToCompare) {
  Spoiled data;
  data.settings.estimate_offset = false;
  data.settings.time_offset_s = 100;
  EXPECT_EQ(
      data.message(),
      "[slom.calibration.no-common-time] hand.csv lasts from 0.000 s to 19.990 s, camera.csv from 0.001 s to 19.952 s: "
      "with the time offset 100 s they have 0 rows in common; correct the offset, or let it be estimated");
  Spoiled brief;
  brief.streams.hand.poses.resize(10);
  EXPECT_EQ(
      brief.message(),
      "[slom.calibration.no-common-time] hand.csv lasts from 0.000 s to 0.090 s, camera.csv from 0.001 s to 19.952 s: "
      "nowhere do both move alike; record one motion with both, of some seconds");
}

TEST(PoseStreams, EqualStampsAndGapsAreNamed) {
  Spoiled data;
  auto& hand = data.streams.hand.poses;
  hand[700].t_s = hand[699].t_s;
  hand.erase(hand.begin() + 1000, hand.begin() + 1100);
  const auto result = handEye(data.streams.hand, data.streams.camera, {});
  ASSERT_TRUE(result.success()) << result.message;
  ASSERT_EQ(result.warnings.size(), 2u);
  EXPECT_EQ(
      result.warnings[0],
      "hand.csv:702: 1 row has the time of the row above (first at 6.990000 s); the later one is left out");
  EXPECT_EQ(
      result.warnings[1],
      "hand.csv:1102: 1 gap without poses, 1.01 s in all, the longest 1.01 s before 11.000000 s; nothing is "
      "interpolated there");
  EXPECT_GE(result.unused, 20);
}

TEST(PoseStreams, AShortHandIsFoundInALongCamera) {
  Spoiled data;
  auto& hand = data.streams.hand.poses;
  hand = {hand.begin() + 800, hand.begin() + 1500};
  const auto result = handEye(data.streams.hand, data.streams.camera, {});
  ASSERT_TRUE(result.success()) << result.message;
  EXPECT_NEAR(result.time_offset_s.value, SimulatedHand().offset, 0.003);
  ASSERT_EQ(result.warnings.size(), 1u);
  EXPECT_EQ(
      result.warnings[0],
      "260 of 400 rows of camera.csv have no pose of hand.csv at their time; record both for the whole motion");
}

}  // namespace
}  // namespace slom::testing
