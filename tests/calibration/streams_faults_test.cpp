// Streams that cannot be used, and motions that leave something open: each is refused with a whole sentence.
#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "calibration/simulated_streams.hpp"

namespace slom::calibration {
namespace {

using testing::datasetOf;
using testing::quickStream;
using testing::streamOf;

/// A recording whose cameras are calibrated once for all tests.
class StreamFaults : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    options = quickStream(3);
    simulated = app::simulateStereoImuStream(options);
    data = datasetOf(options, simulated);
    settings.sigma_px = options.sigma_px;
    camera = calibrate(data, settings);
  }
  static ImuStream good() {
    ImuStream imu = streamOf(simulated);
    imu.noise = options.noise;
    return imu;
  }
  /// Expects the error with this id and text.
  static void expectRefused(const ImuStream& imu, const std::string& id, const std::string& text,
                            const StreamSettings& stream = {}) {
    try {
      calibrateStreams(data, settings, camera, {imu}, stream);
      ADD_FAILURE() << "nothing was thrown instead of: " << text;
    } catch (const DataError& error) {
      EXPECT_EQ(error.id(), "slom.calibration." + id);
      EXPECT_STREQ(error.what(), ("[slom.calibration." + id + "] " + text).c_str());
    }
  }
  static void changeAll(ImuStream& imu, const std::function<void(ImuSample&)>& change) {
    for (ImuSample& sample : imu.samples) change(sample);
  }

  static inline app::StereoImuStreamOptions options;
  static inline app::StereoImuStreamData simulated;
  static inline Dataset data;
  static inline Settings settings;
  static inline Result camera;
};

TEST_F(StreamFaults, TheUnspoiltStreamIsFine) {
  const StreamResult result = calibrateStreams(data, settings, camera, {good()});
  EXPECT_TRUE(result.success()) << result.message << result.undetermined;
  EXPECT_EQ(result.notes, std::vector<std::string>());
}

TEST_F(StreamFaults, DegreesPerSecond) {
  ImuStream imu = good();
  changeAll(imu, [](ImuSample& s) { s.gyro *= 57.29578; });
  expectRefused(
      imu, "bad-stream",
      "imu0: the angular velocities are 57.2 times those of the cameras, as if they were in degrees per "
      "second; convert them to rad/s");
}
TEST_F(StreamFaults, AngularVelocitiesInAnotherUnit) {
  ImuStream imu = good();
  changeAll(imu, [](ImuSample& s) { s.gyro *= 1000; });
  expectRefused(
      imu, "bad-stream",
      "imu0: the angular velocities are 999 times those of the cameras; give rad/s, and the times of both "
      "sensors in one unit");
}
TEST_F(StreamFaults, UnitsOfGravity) {
  ImuStream imu = good();
  changeAll(imu, [](ImuSample& s) { s.force /= 9.80665; });
  expectRefused(
      imu, "bad-stream",
      "imu0: the specific forces have a magnitude of 1 in the median, as if they were in units of gravity; "
      "multiply them by 9.80665");
  changeAll(imu, [](ImuSample& s) { s.force *= 1000; });
  expectRefused(
      imu, "bad-stream",
      "imu0: the specific forces have a magnitude of 1e+03 in the median, as if they were in thousandths of "
      "gravity; multiply them by 0.00980665");
  changeAll(imu, [](ImuSample& s) { s.force *= 0.03; });
  expectRefused(
      imu, "bad-stream",
      "imu0: the specific forces have a magnitude of 30 in the median instead of about 9.8 m/s^2; give "
      "specific forces in m/s^2 in the last three columns, with gravity in them");
}
TEST_F(StreamFaults, ForcesBeforeAngularVelocities) {
  ImuStream imu = good();
  const std::string sentence =
      "imu0: the first three readings have a magnitude of 9.82 in the median, that of gravity, as if accelerometer and "
      "gyroscope were exchanged; give the angular velocities first, and the specific forces after them";
  changeAll(imu, [](ImuSample& s) { std::swap(s.gyro, s.force); });
  expectRefused(imu, "bad-stream", sentence);
  changeAll(imu, [](ImuSample& s) { s.force *= 57.29578; });  // in degrees per second, besides
  expectRefused(imu, "bad-stream", sentence);
}
/// Angular velocities with about the magnitude of gravity, as in degrees per second, are not taken for forces.
TEST_F(StreamFaults, SlowTurnsInDegreesPerSecond) {
  ImuStream imu = good();
  std::vector<double> magnitudes;
  for (const ImuSample& s : imu.samples) magnitudes.push_back(s.gyro.norm());
  std::nth_element(magnitudes.begin(), magnitudes.begin() + long(magnitudes.size() / 2), magnitudes.end());
  const double factor = 9.81 / magnitudes[magnitudes.size() / 2];
  changeAll(imu, [&](ImuSample& s) { s.gyro *= factor, s.force /= 9.80665; });
  expectRefused(
      imu, "bad-stream",
      "imu0: the specific forces have a magnitude of 1 in the median, as if they were in units of gravity; "
      "multiply them by 9.80665");
}
TEST_F(StreamFaults, AxesOfTheOtherHand) {
  ImuStream imu = good();
  changeAll(imu, [](ImuSample& s) { s.gyro[2] = -s.gyro[2], s.force[2] = -s.force[2]; });
  expectRefused(
      imu, "bad-stream",
      "imu0: the angular velocities fit axes of the other hand: 0.015 rad/s off instead of 0.83; change the "
      "sign of one axis, or exchange two, in angular velocity and force");
}
/// If the forces fit as they are, only the angular velocities have the wrong axes.
TEST_F(StreamFaults, AngularVelocitiesOfTheOtherHand) {
  ImuStream imu = good();
  changeAll(imu, [](ImuSample& s) { s.gyro = vec3(-s.gyro); });
  expectRefused(
      imu, "bad-stream",
      "imu0: the angular velocities fit axes of the other hand: 0.015 rad/s off instead of 0.83; give (-x, -y, -z) "
      "as their axes, and leave the forces as they are");
  imu = good();
  changeAll(imu, [](ImuSample& s) { std::swap(s.gyro[0], s.gyro[1]); });
  expectRefused(
      imu, "bad-stream",
      "imu0: the angular velocities fit axes of the other hand: 0.015 rad/s off instead of 0.83; give (y, x, z) as "
      "their axes, and leave the forces as they are");
}
TEST_F(StreamFaults, TimesInAnotherUnitHaveAStrangeRate) {
  ImuStream imu = good();
  changeAll(imu, [](ImuSample& s) { s.time *= 1e-3; });
  expectRefused(
      imu, "bad-stream",
      fmt::format(
          "imu0: the recordings are too short to find the time offset; {} readings come within {:.3g} s, so "
          "check the unit of their times; give images and readings of the same motion",
          imu.samples.size(), imu.samples.back().time - imu.samples.front().time));
}
TEST_F(StreamFaults, ForcesInOtherAxes) {
  const auto sentence = [](const std::string& axes, const std::string& numbers) {
    return "imu0: the specific forces fit the motion of the cameras if " + axes +
           " are their axes: " + numbers +
           "; give forces and angular velocities in the same axes, and forces that point upwards at rest";
  };
  ImuStream imu = good();
  changeAll(imu, [](ImuSample& s) { s.force[2] = -s.force[2]; });
  expectRefused(imu, "bad-stream", sentence("(x, y, -z)", "0.52 m/s^2 off instead of 3.4"));
  imu = good();
  changeAll(imu, [](ImuSample& s) { s.force = vec3(-s.force); });
  expectRefused(imu, "bad-stream", sentence("(-x, -y, -z)", "0.52 m/s^2 off instead of 3.9"));
  imu = good();
  changeAll(imu, [](ImuSample& s) { s.force = vec3(s.force[2], -s.force[0], s.force[1]); });
  expectRefused(imu, "bad-stream", sentence("(-y, z, x)", "0.52 m/s^2 off instead of 3.8"));
}
TEST_F(StreamFaults, TimesThatDoNotRise) {
  ImuStream imu = good();
  imu.samples[7].time = imu.samples[6].time;
  expectRefused(
      imu, "bad-stream",
      "imu0: samples[7] is at 0.030000 s, not after the one before; sort the samples by time, and keep one "
      "of each time");
  imu = good();
  std::swap(imu.samples[20], imu.samples[30]);
  expectRefused(
      imu, "bad-stream",
      "imu0: samples[21] is at 0.105000 s, not after the one before; sort the samples by time, and keep one "
      "of each time");
}
TEST_F(StreamFaults, NumbersThatAreNotFinite) {
  ImuStream imu = good();
  imu.samples[11].force[1] = std::nan("");
  expectRefused(imu, "bad-stream", "imu0: samples[11] is not finite; leave it out");
}
TEST_F(StreamFaults, TooShort) {
  ImuStream imu = good();
  imu.file = "imu.csv";
  imu.samples.resize(1);
  expectRefused(imu, "bad-stream", "imu.csv: there are fewer than two readings; give a recording");
  imu = good();
  imu.samples.resize(100);
  expectRefused(
      imu, "bad-stream",
      "imu0: the recordings are too short to find the time offset; give images and readings of the same "
      "motion");
}
TEST_F(StreamFaults, NoCommonTime) {
  StreamSettings far;
  far.time_offset = 100;
  expectRefused(
      good(), "bad-stream",
      "imu0: no image was taken while the IMU recorded, with this time offset; give images and readings of "
      "the same motion",
      far);
}
TEST_F(StreamFaults, DensitiesThatAreNotPositive) {
  ImuStream imu = good();
  imu.noise->force_walk = 0;
  expectRefused(imu, "bad-stream", "imu0: the density ImuNoise::force_walk is 0; give a positive number");
}

TEST_F(StreamFaults, ImagesWithoutTimes) {
  Dataset other = datasetOf(options, simulated);
  other.cameras[0].views[4].time_ns.reset();
  try {
    calibrateStreams(other, settings, camera, {good()});
    ADD_FAILURE() << "nothing was thrown";
  } catch (const DataError& error) {
    EXPECT_STREQ(
        error.what(),
        "[slom.calibration.bad-stream] camera cam0: image 5 has no time; give corner files with a column "
        "t_ns, or photographs whose names are times in ns");
  }
}
TEST_F(StreamFaults, ImagesTooFarApart) {
  Dataset few = data.withImages([](int image) { return image % 6 == 0; });
  const Result result = calibrate(few, settings);
  try {
    calibrateStreams(few, settings, result, {good()});
    ADD_FAILURE() << "nothing was thrown";
  } catch (const DataError& error) {
    EXPECT_STREQ(
        error.what(),
        "[slom.calibration.bad-stream] imu0: only 0 pairs of images follow each other within 0.5 s; record "
        "images at 4 Hz or more");
  }
}
TEST_F(StreamFaults, CamerasThatAreNotCalibrated) {
  Result failed = camera;
  failed.converged = false;
  try {
    calibrateStreams(data, settings, failed, {good()});
    ADD_FAILURE() << "nothing was thrown";
  } catch (const DataError& error) {
    EXPECT_STREQ(error.what(), "[slom.calibration.no-result] the cameras' own calibration did not succeed");
  }
}

constexpr const char* other_motion =
    " at best, so their clocks cannot be compared; give images and readings of the same motion, with quick turns about "
    "all axes";

/// Expects that a recording of this motion is refused for want of turns.
void expectNoMotion(const app::StereoImuStreamOptions& options, const Dataset& data, const ImuStream& imu,
                    const std::string& beginning, const std::string& end) {
  Settings settings;
  settings.sigma_px = options.sigma_px;
  const Result camera = calibrate(data, settings);
  ASSERT_TRUE(camera.success());
  try {
    calibrateStreams(data, settings, camera, {imu});
    ADD_FAILURE() << "nothing was thrown, seed " << options.seed;
  } catch (const DataError& error) {
    EXPECT_EQ(error.id(), "slom.calibration.no-motion");
    const std::string text = error.what();
    EXPECT_TRUE(text.starts_with("[slom.calibration.no-motion] imu0: " + beginning) && text.ends_with(end))
        << text;
  }
}

TEST(StreamMotion, WithoutTurnsClocksCannotBeCompared) {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    app::StereoImuStreamOptions options = quickStream(seed);
    for (const auto motion : {app::SimulatedMotion::translation, app::SimulatedMotion::rest}) {
      options.motion = motion;
      const auto simulated = app::simulateStereoImuStream(options);
      expectNoMotion(options, datasetOf(options, simulated), streamOf(simulated),
                     "the angular velocities and the turns of the cameras correlate by ", other_motion);
    }
  }
}

TEST(StreamMotion, OfAnotherRigIsNotTheSame) {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const app::StereoImuStreamOptions options = quickStream(seed), other = quickStream(100 + seed);
    expectNoMotion(options, datasetOf(options, app::simulateStereoImuStream(options)),
                   streamOf(app::simulateStereoImuStream(other)),
                   "the angular velocities and the turns of the cameras correlate by ", other_motion);
  }
}

/// Magnitudes that correlate by chance are not enough.
TEST(StreamMotion, DirectionsOfTurnsMustAgree) {
  const app::StereoImuStreamOptions options = quickStream(49), other = quickStream(1049);
  expectNoMotion(
      options, datasetOf(options, app::simulateStereoImuStream(options)),
      streamOf(app::simulateStereoImuStream(other)), "the angular velocities vary by ",
      " rad/s from those of the cameras, turned as fits best; give images and readings of the same motion, "
      "with quick turns about all axes");
}

/// With so much noise, the accelerometer hardly tells where it sits: nothing is promised.
TEST(StreamMotion, PosesThatAreHardlyKnownAreUndetermined) {
  app::StereoImuStreamOptions options = quickStream(2);
  options.noise.force = 0.5;
  const auto simulated = app::simulateStereoImuStream(options);
  const Dataset data = datasetOf(options, simulated);
  Settings settings;
  settings.sigma_px = options.sigma_px;
  ImuStream imu = streamOf(simulated);
  imu.noise = options.noise;
  const StreamResult result = calibrateStreams(data, settings, calibrate(data, settings), {imu});
  EXPECT_TRUE(result.converged);
  EXPECT_FALSE(result.success());
  EXPECT_EQ(
      result.undetermined,
      "the position of imu0 along (-0.08, 0.04, 1.00) in the axes of the IMU is known to 0.12 m only; turn the rig "
      "about all axes, quickly");
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(std::isnan(result.imus[0].translation_std[i]));
    EXPECT_TRUE(std::isnan(result.imus[0].rotation_std[i]));
    EXPECT_TRUE(std::isnan(result.imus[0].translation_clustered[i]));
  }
  EXPECT_TRUE(std::isnan(result.imus[0].time_offset_std));
  EXPECT_TRUE(std::isnan(result.gravity_direction_std));
  EXPECT_NEAR(result.imus[0].time_offset, options.time_offset, 1e-3);  // gyroscope and cameras agree
}

TEST(StreamMotion, AboutOneAxisLeavesAPositionOpen) {
  app::StereoImuStreamOptions options = quickStream(1, 8);
  options.motion = app::SimulatedMotion::one_axis;
  const auto simulated = app::simulateStereoImuStream(options);
  expectNoMotion(
      options, datasetOf(options, simulated), streamOf(simulated),
      "the rig turns about one axis only, (-0.10, 0.19, 0.98) in the axes of the IMU, so the position of "
      "the IMU along this axis is not determined; ",
      "turn the rig about all axes");
}

}  // namespace
}  // namespace slom::calibration
