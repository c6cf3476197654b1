// The verdict on IMUs in motion: trustworthy for good recordings, and doubtful with the cause for those that have one.
#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "calibration/simulated_streams.hpp"
#include "support/fresh_seed.hpp"

namespace slom::calibration {
namespace {

using testing::Calibrated;
using testing::datasetOf;
using testing::quickStream;
using testing::streamOf;

Verdict verdictWith(const Calibrated& rig, const std::vector<ImuStream>& imus,
                    const StreamSettings& stream = {}) {
  return verdictOf(rig.with(imus, stream), rig.camera);
}

std::string textOf(const Verdict& verdict) {
  std::string text = std::string(toString(verdict.level)) + ": " + verdict.sentence;
  for (const std::string& doubt : verdict.doubts) text += "\n" + doubt;
  return text;
}

TEST(StreamVerdict, GoodRecordingsAreTrustworthy) {
  const unsigned seed = slom::testing::freshSeed();
  for (unsigned k = 0; k < 4; ++k) {
    const Calibrated rig(quickStream(seed + k));
    ImuStream imu = rig.stream();
    if (k % 2 == 1) imu.noise.reset();
    const Verdict verdict = verdictWith(rig, {imu});
    EXPECT_EQ(verdict.level, Verdict::Level::trustworthy) << seed + k << ": " << textOf(verdict);
    EXPECT_TRUE(verdict.sentence.starts_with("The pose of imu0 is known to ")) << verdict.sentence;
  }
}

TEST(StreamVerdict, AScaleIsNamedAndEstimated) {
  const Calibrated rig(quickStream(slom::testing::freshSeed(), 12));
  ImuStream imu = rig.stream();
  for (ImuSample& sample : imu.samples) sample.gyro = vec3(1.03 * sample.gyro);
  const Verdict verdict = verdictWith(rig, {imu});
  EXPECT_EQ(verdict.level, Verdict::Level::doubtful) << textOf(verdict);
  EXPECT_NE(textOf(verdict).find("the scales or axes of "), std::string::npos) << textOf(verdict);
  EXPECT_EQ(textOf(verdict).find(" lag "), std::string::npos) << textOf(verdict);
  StreamSettings other;
  other.axes = ImuAxes::scale_misalignment;
  for (const std::string& doubt : verdictWith(rig, {imu}, other).doubts)
    EXPECT_NE(doubt.find("the recording determines "), std::string::npos) << doubt;
}

/// Without the noise of the readings, a fit takes errors of axes for noise.
TEST(StreamVerdict, ASmallScaleIsDoubtedBySplinesWithoutNoiseToo) {
  const Calibrated rig(quickStream(slom::testing::freshSeed(), 12));
  StreamSettings splines;
  splines.path = StreamPath::splines;
  ImuStream imu = rig.stream();
  imu.noise.reset();
  const Verdict good = verdictWith(rig, {imu}, splines);
  EXPECT_EQ(good.level, Verdict::Level::trustworthy) << textOf(good);
  for (ImuSample& sample : imu.samples) sample.gyro = vec3(1.015 * sample.gyro);
  const Verdict scaled = verdictWith(rig, {imu}, splines);
  EXPECT_EQ(scaled.level, Verdict::Level::doubtful) << textOf(scaled);
}

/// Delays the forces by `samples` readings. Leaves out the first readings, which then have no force.
ImuStream withLateForces(const ImuStream& imu, std::size_t samples) {
  ImuStream late = imu;
  late.samples.erase(late.samples.begin(), late.samples.begin() + std::ptrdiff_t(samples));
  for (std::size_t i = 0; i < late.samples.size(); ++i) late.samples[i].force = imu.samples[i].force;
  return late;
}

/// Expects the pose and the clock of the simulation, within 5 standard deviations.
void expectTruth(const Calibrated& rig, const StreamResult& result) {
  ASSERT_TRUE(result.success()) << result.message << result.undetermined;
  const ImuStreamResult& imu = result.imus[0];
  const SE3& is = rig.options.cam0_to_imu;
  const vec3 turn = SO3::log(is.orient.inverse() * imu.left2imu.orient);
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT(std::abs(imu.left2imu.pos[i] - is.pos[i]),
              5 * std::max(imu.translation_std[i], imu.translation_clustered[i]))
        << i;
    EXPECT_LT(std::abs(turn[i]), 5 * std::max(imu.rotation_std[i], imu.rotation_clustered[i])) << i;
  }
  EXPECT_LT(std::abs(imu.time_offset - rig.options.time_offset),
            5 * std::max(imu.time_offset_std, imu.time_offset_clustered));
}

TEST(StreamVerdict, AnAccelerometerThatLagsIsNamedAndItsLagIsRemoved) {
  const unsigned seed = slom::testing::freshSeed();
  SCOPED_TRACE("seed " + std::to_string(seed));
  const Calibrated rig(quickStream(seed, 12));
  ImuStream imu = rig.stream();
  for (const StreamPath path : {StreamPath::preintegration, StreamPath::splines}) {
    if (path == StreamPath::splines) imu.noise.reset();
    StreamSettings settings;
    settings.path = path;
    const std::size_t samples = path == StreamPath::splines ? 1 : 2;
    const double late = 0.005 * double(samples);  // at 200 Hz
    const StreamResult result = rig.with({withLateForces(imu, samples)}, settings);
    const std::string text = textOf(verdictOf(result, rig.camera));
    const std::string before = "the accelerometer of imu0 lags behind its gyroscope by ";
    const std::size_t found = text.find(before);
    ASSERT_NE(found, std::string::npos) << text;
    EXPECT_NEAR(std::stod(text.substr(found + before.size())), 1e3 * late, 0.8) << text;
    ASSERT_TRUE(result.imus[0].force_lag);
    const StreamNumber& lag = *result.imus[0].force_lag;
    EXPECT_NEAR(lag.value, late, 0.8e-3);
    EXPECT_LT(std::abs(lag.value - late), 5 * lag.std);
    EXPECT_LT(lag.std, late / 10);  // as the verdict asks for
    EXPECT_EQ(text.find("axes"), std::string::npos) << text;
    expectTruth(rig, result);
  }
}

TEST(StreamVerdict, ADriftingClockIsADoubt) {
  const Calibrated rig(quickStream(slom::testing::freshSeed(), 12));
  ImuStream imu = rig.stream();
  for (ImuSample& sample : imu.samples) sample.time *= 1.001;
  const StreamResult result = rig.with({imu});
  const Verdict verdict = verdictOf(result, rig.camera);
  EXPECT_NE(verdict.level, Verdict::Level::trustworthy) << textOf(verdict);
  EXPECT_EQ(textOf(verdict).find(" lag "), std::string::npos) << textOf(verdict);
  if (result.success()) {
    EXPECT_NE(textOf(verdict).find("the clock of imu0 drifts"), std::string::npos) << textOf(verdict);
  }
}

TEST(StreamVerdict, AFitThatFailedIsNamed) {
  const Calibrated rig(quickStream(3));
  StreamResult result = rig.with({rig.stream()});
  result.undetermined = "the position is open";
  Verdict verdict = verdictOf(result, rig.camera);
  EXPECT_EQ(textOf(verdict),
            "failed: The fit of the IMU failed: the position is open. Its values must not be used.");
  result.undetermined.clear();
  result.converged = false;
  result.message = "the limit of iterations";
  EXPECT_EQ(verdictOf(result, rig.camera).sentence,
            "The fit of the IMU failed: the limit of iterations. Its values must not be used.");
}

/// A recording of two cameras with line delays and an offset that no stamp shows. What the fit holds, the verdict tells.
TEST(StreamVerdict, HeldClocksAndShuttersAreTold) {
  app::StereoImuStreamOptions options = quickStream(slom::testing::freshSeed());
  options.camera_phase = 0.003;
  options.camera_offset = -0.003;
  options.line_delay = 3e-5;
  const app::StereoImuStreamData simulated = app::simulateStereoImuStream(options);
  const Dataset data = datasetOf(options, simulated, 2);
  ImuStream imu = streamOf(simulated);
  imu.noise = options.noise;
  for (const auto& [has_offsets, has_shutters] : {std::pair(false, true), {true, false}, {true, true}}) {
    Settings settings;
    settings.sigma_px = options.sigma_px;
    settings.rolling_shutter = has_shutters;
    StreamSettings stream;
    stream.path = StreamPath::splines;
    stream.camera_offsets = has_offsets;
    const StreamResult result = calibrateMovingCameras(data, settings, {imu}, stream).result;
    const std::string text = textOf(verdictOf(result, Result()));
    SCOPED_TRACE(text);
    EXPECT_EQ(text.find("if the clock of cam1 differs by -") != std::string::npos, !has_offsets);
    EXPECT_EQ(text.find("if cam0 has a line delay of ") != std::string::npos, !has_shutters);
    EXPECT_EQ(text.find("if cam1 has a line delay of ") != std::string::npos, !has_shutters);
    EXPECT_EQ(text.substr(0, 11) == "trustworthy", has_offsets && has_shutters);
  }
}

}  // namespace
}  // namespace slom::calibration
