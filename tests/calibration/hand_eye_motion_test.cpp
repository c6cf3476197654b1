// Which motions determine what, clocks, drift, pairs and wrong streams, on simulated hands.
#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "calibration/hand_eye_streams.hpp"

namespace slom::testing {
namespace {

using calibration::FreeDirection;
using calibration::HandEyeResult;
using calibration::HandEyeSettings;

HandEyeResult calibrated(const SimulatedHand& truth, const HandEyeSettings& settings = {}) {
  const SimulatedStreams streams = simulated(truth);
  return handEye(streams.hand, streams.camera, settings);
}

int countOf(const HandEyeResult& result, FreeDirection::Kind kind) {
  return int(std::count_if(result.free.begin(), result.free.end(),
                           [&](const auto& free) { return free.kind == kind; }));
}

double turnBetween(const SO3& a, const SO3& b) { return SO3::log(a.inverse() * b).norm(); }

/// Expects values near the truth, by standard deviations.
void expectTruth(const HandEyeResult& result, const SimulatedHand& truth, double sigmas = 4.5) {
  ASSERT_TRUE(result.success()) << result.message << (result.free.empty() ? "" : result.free.front().text);
  Eigen::Matrix<double, 6, 1> error;
  result.hand_T_camera.pose.boxminus(mtk::vectview<double, 6>(error.data()), truth.hand_T_camera);
  for (int k = 0; k < 6; ++k) EXPECT_LT(std::abs(error[k]), sigmas * result.hand_T_camera.std[k]) << k;
}

/// Error of interpolation between poses at 100 Hz [rad], [m].
constexpr double interpolation = 2e-5;

TEST(HandEyeMotion, OneAxisLeavesTheTranslationAlongItFree) {
  for (const double noise : {1e-6, 0.005}) {
    SimulatedHand truth;
    truth.motion = HandMotion::one_axis;
    truth.noise_m = truth.noise_rad = noise;
    const HandEyeResult result = calibrated(truth);
    EXPECT_TRUE(result.converged) << result.message;
    ASSERT_EQ(result.free.size(), 1u) << noise;
    EXPECT_EQ(result.free[0].kind, FreeDirection::Kind::translation);
    EXPECT_NEAR(std::abs(result.free[0].axis[2]), 1, 1e-3);
    EXPECT_EQ(result.free[0].text.substr(0, 72),
              "the translation of the camera along (0.000, 0.000, 1.000) of the hand is");
    // What is determined is right, and has a standard deviation; the rest has none.
    EXPECT_TRUE(std::isnan(result.hand_T_camera.std[2]));
    for (const int k : {0, 1}) {
      EXPECT_NEAR(result.hand_T_camera.pose.pos[k], truth.hand_T_camera.pos[k],
                  5 * result.hand_T_camera.std[k] + interpolation)
          << k;
    }
    EXPECT_LT(turnBetween(result.hand_T_camera.pose.orient, truth.hand_T_camera.orient),
              6 * result.hand_T_camera.std[5] + interpolation);
    EXPECT_NEAR(result.hand_T_camera.pose.pos[2], 0, 1e-3);  // held
    EXPECT_NEAR(result.time_offset_s.value, truth.offset, 5 * result.time_offset_s.std + interpolation);
  }
}

TEST(HandEyeMotion, OneScrewLeavesTheTurnAboutItFreeToo) {
  for (const double noise : {1e-6, 0.005}) {
    SimulatedHand truth;
    truth.motion = HandMotion::one_screw;
    truth.noise_m = truth.noise_rad = noise;
    const HandEyeResult result = calibrated(truth);
    EXPECT_EQ(result.free.size(), 2u) << noise;
    EXPECT_EQ(countOf(result, FreeDirection::Kind::translation), 1) << noise;
    ASSERT_EQ(countOf(result, FreeDirection::Kind::rotation), 1) << noise;
    for (const FreeDirection& free : result.free) EXPECT_NEAR(std::abs(free.axis[2]), 1, 0.02) << free.text;
    EXPECT_FALSE(result.success());
  }
}

TEST(HandEyeMotion, WithoutTurnsTheTranslationIsFree) {
  for (const double noise : {1e-6, 0.003}) {
    SimulatedHand truth;
    truth.motion = HandMotion::translation;
    truth.noise_m = truth.noise_rad = noise;
    const HandEyeResult result = calibrated(truth);
    EXPECT_TRUE(result.converged) << result.message;
    EXPECT_EQ(result.free.size(), 3u) << noise;
    EXPECT_EQ(countOf(result, FreeDirection::Kind::translation), 3) << noise;
    EXPECT_LT(turnBetween(result.hand_T_camera.pose.orient, truth.hand_T_camera.orient), 0.01);
    EXPECT_NEAR(result.time_offset_s.value, truth.offset, 0.002);
  }
}

TEST(HandEyeMotion, AtRestNothingIsPromised) {
  SimulatedHand truth;
  truth.motion = HandMotion::rest;
  HandEyeSettings settings;
  settings.estimate_offset = false;
  const HandEyeResult result = calibrated(truth, settings);
  EXPECT_FALSE(result.success());
  EXPECT_TRUE(!result.converged || result.free.size() >= 6) << result.free.size();
}

TEST(HandEyeMotion, TheOffsetFollowsTheStamps) {
  SimulatedHand truth;
  truth.noise_m = truth.noise_rad = 0.001;
  SimulatedStreams streams = simulated(truth);
  const double offset = handEye(streams.hand, streams.camera, {}).time_offset_s.value;
  EXPECT_NEAR(offset, truth.offset, 1e-3);
  for (const double shift : {-2.0, -1.0, -0.3, 0.7, 2.0, 1e9}) {
    PoseStream camera = streams.camera;
    for (auto& pose : camera.poses) pose.t_s += shift;
    const HandEyeResult result = handEye(streams.hand, camera, {});
    EXPECT_TRUE(result.success()) << shift;
    EXPECT_NEAR(result.time_offset_s.value + shift, offset, 1e-4) << shift;
    const bool is_delayed = std::abs(truth.offset - shift) > 1;
    EXPECT_EQ(result.warnings.size(), is_delayed ? 1u : 0u) << shift;
  }
}

TEST(HandEyeMotion, ADelayOfMoreThanASecondIsNamed) {
  SimulatedHand truth;
  truth.offset = 1.75;
  truth.noise_m = truth.noise_rad = 0;
  const HandEyeResult result = calibrated(truth);
  ASSERT_EQ(result.warnings.size(), 1u);
  EXPECT_EQ(
      result.warnings[0],
      "the stamps of hand.csv are 1.750 s later than those of camera.csv; if both shall have one clock, correct "
      "the sensor that is delayed");
  truth.epoch = 1.7e9;
  const HandEyeResult other = calibrated(truth);
  ASSERT_EQ(other.warnings.size(), 1u);
  EXPECT_EQ(
      other.warnings[0],
      "the clocks of hand.csv and camera.csv have other epochs: 1700000001.750 s apart; add the offset to the times "
      "of the camera wherever both are used");
}

TEST(HandEyeMotion, TheFasterStreamIsInterpolatedWhicheverItIs) {
  SimulatedHand truth;
  truth.hand_rate = 20;
  truth.camera_rate = 100;
  expectTruth(calibrated(truth), truth);
  EXPECT_NEAR(calibrated(truth).time_offset_s.value, truth.offset, 5 * calibrated(truth).time_offset_s.std);
}

TEST(HandEyeMotion, AKnownOffsetStays) {
  SimulatedHand truth;
  HandEyeSettings settings;
  settings.estimate_offset = false;
  settings.time_offset_s = truth.offset;
  const HandEyeResult result = calibrated(truth, settings);
  expectTruth(result, truth);
  EXPECT_EQ(result.time_offset_s.value, truth.offset);
  EXPECT_EQ(result.time_offset_s.std, 0);
}

TEST(HandEyeMotion, MotionsAreImmuneToDrift) {
  SimulatedHand truth;
  truth.seconds = 60;
  truth.drift_m = 0.02;
  truth.drift_rad = 0.02;
  truth.noise_m = truth.noise_rad = 0.002;
  HandEyeSettings settings;
  settings.drifting = true;
  const HandEyeResult result = calibrated(truth, settings);
  ASSERT_TRUE(result.success()) << result.message;
  EXPECT_FALSE(result.base_T_target);
  EXPECT_GT(result.motions, 1000);
  Eigen::Matrix<double, 6, 1> error;
  result.hand_T_camera.pose.boxminus(mtk::vectview<double, 6>(error.data()), truth.hand_T_camera);
  // Motions overlap, so their errors depend on each other: the clustered standard deviations count.
  for (int k = 0; k < 6; ++k) EXPECT_LT(std::abs(error[k]), 4 * result.hand_T_camera.std_clustered[k]) << k;
}

TEST(HandEyeMotion, ExactStreamsGiveTheTruth) {
  SimulatedHand truth;
  truth.noise_m = truth.noise_rad = 0;
  truth.hand_rate = 1000;  // so that interpolation is exact to 1e-6
  const HandEyeResult result = calibrated(truth);
  ASSERT_TRUE(result.success()) << result.message;
  EXPECT_LT((result.hand_T_camera.pose.pos - truth.hand_T_camera.pos).norm(), 1e-5);
  EXPECT_LT(turnBetween(result.hand_T_camera.pose.orient, truth.hand_T_camera.orient), 1e-5);
  EXPECT_NEAR(result.time_offset_s.value, truth.offset, 1e-5);
}

TEST(HandEyeMotion, InversePosesAreNamed) {
  const SimulatedStreams streams = simulated({});
  PoseStream inverse = streams.camera;
  for (auto& pose : inverse.poses) pose.pose = pose.pose.inverse();
  const HandEyeResult result = handEye(streams.hand, inverse, {});
  EXPECT_FALSE(result.converged);
  EXPECT_TRUE(result.camera_seems.is_inverse);
  EXPECT_FALSE(result.hand_seems.is_inverse || result.hand_seems.has_w_first ||
               result.camera_seems.has_w_first);
  EXPECT_TRUE(result.message.ends_with(
      "; the inverse poses of camera.csv, or those of hand.csv, agree far better, so invert them"))
      << result.message;
}

TEST(HandEyeMotion, StreamsOfOtherMotionsDoNotSucceed) {
  SimulatedHand other;
  other.motion = HandMotion::one_axis;
  SimulatedStreams streams = simulated({});
  PoseStream camera = simulated(other).camera;
  std::reverse(camera.poses.begin(), camera.poses.end());
  for (auto& pose : camera.poses) pose.t_s = 100 - pose.t_s;
  try {
    const HandEyeResult result = handEye(streams.hand, camera, {});
    EXPECT_FALSE(result.success());
  } catch (const mtk::Error& error) {
    EXPECT_EQ(error.id(), "slom.calibration.no-common-time");
  }
}

}  // namespace
}  // namespace slom::testing
