// Biases that jump and stay, on simulated recordings.
//
// SLOM_JUMP_RIGS=10 takes that many clean rigs instead of 2.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

#include "calibration/simulated_streams.hpp"
#include "support/fresh_seed.hpp"

namespace slom::calibration {
namespace {

using testing::Calibrated;
using testing::quickStream;

StreamSettings by(StreamPath path) {
  StreamSettings settings;
  settings.path = path;
  return settings;
}

/// Returns the readings whose biases jump at a time.
ImuStream withJump(ImuStream imu, double time, const vec3& gyro, const vec3& force) {
  imu.noise.reset();
  for (ImuSample& sample : imu.samples) {
    if (sample.time < time) continue;
    sample.gyro = vec3(sample.gyro + gyro);
    sample.force = vec3(sample.force + force);
  }
  return imu;
}

/// Returns the note on jumps; empty if there is none.
std::string noteOnJumps(const StreamResult& result) {
  for (const std::string& note : result.notes) {
    if (note.find("biases jump") != std::string::npos) return note;
  }
  return "";
}

/// Expects the pose of a fit without the jump, within 3 standard deviations, and that of the simulation, within 5.
void expectSame(const ImuStreamResult& found, const ImuStreamResult& without,
                const app::StereoImuStreamOptions& truth) {
  const auto z = [](double difference, double std, double clustered) {
    return std::abs(difference) / std::max(std, clustered);
  };
  const vec3 turn = SO3::log(without.left2imu.orient.inverse() * found.left2imu.orient);
  for (int i = 0; i < 3; ++i) {
    const double std = found.translation_std[i], clustered = found.translation_clustered[i];
    EXPECT_LT(z(found.left2imu.pos[i] - without.left2imu.pos[i], std, clustered), 3) << i;
    EXPECT_LT(z(found.left2imu.pos[i] - truth.cam0_to_imu.pos[i], std, clustered), 5) << i;
    EXPECT_LT(z(turn[i], found.rotation_std[i], found.rotation_clustered[i]), 3) << i;
    EXPECT_LT(found.translation_std[i], 1.5 * without.translation_std[i]) << i;
  }
  for (int i = 0; i < 3; ++i) {  // of the time before the jump, in which they walk
    const double gyro_walk = 1e-4, force_walk = 2e-3;
    EXPECT_LT(std::abs(found.gyro_bias[i] - truth.gyro_bias[i]),
              5 * std::max(found.gyro_bias_std[i], found.gyro_bias_clustered[i]) + gyro_walk)
        << i;
    EXPECT_LT(std::abs(found.force_bias[i] - truth.force_bias[i]),
              5 * std::max(found.force_bias_std[i], found.force_bias_clustered[i]) + force_walk)
        << i;
  }
  EXPECT_LT(z(found.time_offset - without.time_offset, found.time_offset_std, found.time_offset_clustered),
            3);
}

TEST(BiasJumps, AreFoundAndNamed) {
  const unsigned seed = slom::testing::freshSeed();
  SCOPED_TRACE("seed " + std::to_string(seed));
  const Calibrated rig(quickStream(seed, 12));
  const double middle = (rig.stream().samples.front().time + rig.stream().samples.back().time) / 2 + 0.013;
  const vec3 none(0., 0., 0.), gyro(0.03, -0.04, 0.), force(0., 0.15, -0.42);
  for (const StreamPath path : {StreamPath::preintegration, StreamPath::splines}) {
    const StreamResult without = rig.with({withJump(rig.stream(), middle, none, none)}, by(path));
    for (const auto& [turn, push] : {std::pair(gyro, none),
                                     {none, force},
                                     {gyro, force},
                                     {none, vec3(2 * force)},
                                     {none, vec3(4 * force)}}) {
      if (path == StreamPath::splines && (turn == none || push == none)) continue;
      SCOPED_TRACE(std::string(toString(path)) + (turn == none ? "" : ", gyroscope") +
                   (push == none ? "" : ", accelerometer"));
      const StreamResult result = rig.with({withJump(rig.stream(), middle, turn, push)}, by(path));
      ASSERT_TRUE(result.success()) << result.message << result.undetermined;
      expectSame(result.imus[0], without.imus[0], rig.options);
      const std::vector<BiasJump>& jumps = result.imus[0].jumps;
      ASSERT_EQ(jumps.size(), std::size_t(turn != none) + std::size_t(push != none));
      for (const BiasJump& jump : jumps) {
        EXPECT_NEAR(jump.time, middle, 0.2);
        // Sizes are differences of means over 1 s of biases that may change freely; the fit takes up the rest.
        EXPECT_LT((jump.change - (jump.is_gyro ? turn : push)).norm(),
                  jump.is_gyro ? 5e-3 : 0.06 + 0.1 * push.norm());
      }
      const std::string note = noteOnJumps(result);
      EXPECT_TRUE(note.starts_with("imu0: biases jump and stay, that of the ")) << note;
      EXPECT_NE(note.find(turn != none ? " rad/s at " : " m/s^2 at "), std::string::npos) << note;
    }
  }
}

TEST(BiasJumps, OfCleanRecordingsAreNotFound) {
  const unsigned seed = slom::testing::freshSeed();
  const char* const given = std::getenv("SLOM_JUMP_RIGS");
  for (unsigned rig = 0; rig < unsigned(given ? std::atoi(given) : 2); ++rig) {
    SCOPED_TRACE("seed " + std::to_string(seed + rig));
    const Calibrated recording(quickStream(seed + rig, 12));
    ImuStream imu = recording.stream();
    imu.noise.reset();
    const StreamResult result = recording.with({imu});
    EXPECT_TRUE(result.success()) << result.message;
    EXPECT_EQ(noteOnJumps(result), "");
    EXPECT_TRUE(result.imus[0].jumps.empty());
  }
}

TEST(BiasJumps, AreKeptWithoutRobustness) {
  Calibrated rig(quickStream(33, 12));
  rig.settings.robust = Robust::none;
  rig.camera = calibrate(rig.data, rig.settings);
  const StreamResult result = rig.with({withJump(rig.stream(), 6, vec3(0.03, -0.04, 0.), vec3(0., 0., 0.))});
  EXPECT_EQ(noteOnJumps(result), "");
  EXPECT_TRUE(result.imus[0].jumps.empty());
}

}  // namespace
}  // namespace slom::calibration
