// Cameras in motion with clocks of their own and rolling shutters, on simulated recordings.
//
// SLOM_MOVING_RIGS=30 takes that many rigs instead of 3.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "calibration/simulated_streams.hpp"
#include "slom/analyze/chi_square.hpp"
#include "support/fresh_seed.hpp"

namespace slom::calibration {
namespace {

using testing::datasetOf;
using testing::quickStream;
using testing::streamOf;

/// A recording of a stereo camera, and its fit.
struct MovingRig {
  explicit MovingRig(const app::StereoImuStreamOptions& given, int cameras = 2)
      : options(given),
        simulated(app::simulateStereoImuStream(given)),
        data(datasetOf(given, simulated, cameras)) {
    settings.sigma_px = options.sigma_px;
    settings.rolling_shutter = options.line_delay != 0;
    stream.path = StreamPath::splines;
    stream.camera_offsets = true;
    imu = streamOf(simulated);
    imu.noise = options.noise;
  }
  MovingCameras fit() const { return calibrateMovingCameras(data, settings, {imu}, stream); }

  app::StereoImuStreamOptions options;
  app::StereoImuStreamData simulated;
  Dataset data;
  Settings settings;
  StreamSettings stream;
  ImuStream imu;
};

/// Errors divided by their stated standard deviations, by name.
using Errors = std::map<std::string, double>;

Errors errorsOf(const MovingRig& rig, const StreamResult& result) {
  Errors z;
  const ImuStreamResult& imu = result.imus[0];
  const SE3& is = rig.options.cam0_to_imu;
  const vec3 turn = SO3::log(is.orient.inverse() * imu.left2imu.orient);
  for (int i = 0; i < 3; ++i) {
    const std::string axis(1, "xyz"[i]);
    z["imu0.translation." + axis] = (imu.left2imu.pos[i] - is.pos[i]) / imu.translation_std[i];
    z["imu0.rotation." + axis] = turn[i] / imu.rotation_std[i];
  }
  z["imu0.time_offset"] = (imu.time_offset - rig.options.time_offset) / imu.time_offset_std;
  for (std::size_t c = 0; c < result.cameras.size(); ++c) {
    const CameraStreamResult& camera = result.cameras[c];
    if (const auto& delay = camera.line_delay)
      z[camera.name + ".line_delay"] = (delay->value - rig.options.line_delay) / delay->std;
    if (const auto& offset = camera.time_offset)
      z[camera.name + ".time_offset"] = (offset->value - rig.options.camera_offset) / offset->std;
    if (c == 0) continue;
    const SE3& place = rig.simulated.cam0_to_cam1;
    const vec3 turned = SO3::log(place.orient.inverse() * camera.left2camera.orient);
    for (int i = 0; i < 3; ++i) {
      const std::string axis(1, "xyz"[i]);
      z[camera.name + ".translation." + axis] =
          (camera.left2camera.pos[i] - place.pos[i]) / camera.translation_std[i];
      z[camera.name + ".rotation." + axis] = turned[i] / camera.rotation_std[i];
    }
  }
  return z;
}

/// Expects errors that one of 10^6 good fits exceeds.
void expectErrorsAsStated(const MovingRig& rig, const StreamResult& result) {
  ASSERT_TRUE(result.success()) << result.message << result.undetermined;
  for (const auto& [name, z] : errorsOf(rig, result)) EXPECT_LT(std::abs(z), 4.9) << name;
}

TEST(MovingCameras, ErrorsAreThoseThatAreStated) {
  const unsigned seed = slom::testing::freshSeed();
  const char* const given = std::getenv("SLOM_MOVING_RIGS");
  const int rigs = given ? std::atoi(given) : 3;
  std::map<std::string, double> squares;
  for (int r = 0; r < rigs; ++r) {
    SCOPED_TRACE("seed " + std::to_string(seed + unsigned(r)));
    app::StereoImuStreamOptions options = quickStream(seed + std::uint64_t(r));
    options.camera_offset = 0.004 * (r % 5 - 2);
    options.camera_phase = 0.01 * (r % 7);
    options.line_delay = r % 2 == 0 ? 3e-5 : -2e-5;
    const MovingRig rig(options);
    const StreamResult result = rig.fit().result;
    ASSERT_TRUE(result.success()) << result.message << result.undetermined;
    ASSERT_EQ(result.cameras.size(), 2u);
    EXPECT_FALSE(result.cameras[0].time_offset);
    EXPECT_LT(result.cameras[1].time_offset->std, 1e-4);
    EXPECT_LT(result.cameras[0].line_delay->std, 3e-7);
    for (const auto& [name, z] : errorsOf(rig, result)) squares[name] += z * z;
  }
  EXPECT_EQ(squares.size(), 16u);
  for (const auto& [name, sum] : squares) {
    std::printf("%-22s mean square of %d rigs %.2f\n", name.c_str(), rigs, sum / rigs);
    EXPECT_LT(sum, chiSquareCritical(1e-6, rigs)) << name;
    EXPECT_GT(sum, chiSquareCritical(1 - 1e-6, rigs)) << name;
  }
}

/// A delay that no stamp shows, and clocks that differ by years.
TEST(MovingCameras, OffsetsAreFollowed) {
  for (const auto& [offset, phase] : {std::pair(0.005, -0.005), {0., 0.}, {-1e6, 0.03}}) {
    SCOPED_TRACE(offset);
    app::StereoImuStreamOptions options = quickStream(slom::testing::freshSeed());
    options.camera_offset = offset;
    options.camera_phase = phase;
    const MovingRig rig(options);
    expectErrorsAsStated(rig, rig.fit().result);
  }
}

/// Without the option, a note names images whose times differ, and the option.
TEST(MovingCameras, OtherTimesAreNoted) {
  app::StereoImuStreamOptions options = quickStream(29);
  for (const double phase : {0., 0.0005}) {
    options.camera_phase = phase;
    MovingRig rig(options);
    for (View& view : rig.data.cameras[1].views) {  // paired as readRig() pairs stamps
      const auto near = [&](const View& one) { return std::abs(*one.time_ns - *view.time_ns) < 1'000'000; };
      const auto& images = rig.data.cameras[0].views;
      const auto pair = std::find_if(images.begin(), images.end(), near);
      if (pair != images.end()) view.image = pair->image;
    }
    const Result cameras = calibrate(rig.data, rig.settings);
    const StreamResult result = calibrateStreams(rig.data, rig.settings, cameras, {rig.imu});
    const std::string note =
        "Images of cam1 count as simultaneous with those of other cameras, and their times differ by 0.5 ms in the "
        "median: if the cameras are not synchronised, add --camera-offsets.";
    const auto count = std::count(result.notes.begin(), result.notes.end(), note);
    EXPECT_EQ(count, phase > 0 ? 1 : 0) << phase;
  }
}

TEST(MovingCameras, StampsAreTrustedIfNoOffsetIsEstimated) {
  app::StereoImuStreamOptions options = quickStream(slom::testing::freshSeed());
  options.camera_phase = 0.04;
  MovingRig rig(options);
  rig.stream.camera_offsets = false;
  const StreamResult result = rig.fit().result;
  expectErrorsAsStated(rig, result);
  EXPECT_FALSE(result.cameras[1].time_offset || result.cameras[1].line_delay);
}

/// Corners that are moved to the images of the first camera fit as those of a synchronised rig.
TEST(MovingCameras, MovedCornersAreSimultaneous) {
  app::StereoImuStreamOptions options = quickStream(slom::testing::freshSeed());
  options.camera_phase = 0.02;
  options.line_delay = 4e-5;
  const MovingRig rig(options);
  const MovingCameras moving = rig.fit();
  ASSERT_TRUE(moving.result.success()) << moving.result.message;
  Settings settings = rig.settings;
  settings.rolling_shutter = false;
  const Result cameras = calibrate(moving.simultaneous, settings);
  ASSERT_TRUE(cameras.success()) << cameras.message;
  for (const CameraResult& camera : cameras.cameras)
    EXPECT_NEAR(camera.rms_px, options.sigma_px * std::sqrt(2.), 0.15 * options.sigma_px);
  EXPECT_LT((cameras.cameras[1].left2camera.pos - rig.simulated.cam0_to_cam1.pos).norm(), 1e-3);
  for (std::size_t c = 0; c < 2; ++c) {
    for (const View& view : moving.simultaneous.cameras[c].views) {
      const auto same = rig.data.cameras[0].find(view.image);
      if (!same) continue;
      EXPECT_EQ(view.time_ns, same->time_ns);
    }
  }
}

TEST(MovingCameras, OneCameraMayHaveARollingShutter) {
  app::StereoImuStreamOptions options = quickStream(slom::testing::freshSeed());
  options.line_delay = 5e-5;
  MovingRig rig(options, 1);
  rig.stream.camera_offsets = false;
  expectErrorsAsStated(rig, rig.fit().result);
}

std::string joined(const std::vector<std::string>& sentences) {
  std::string text;
  for (const std::string& sentence : sentences) text += sentence + "\n";
  return text;
}

/// A jump of a bias and a lag of the forces are found and removed, with both kinds of shutters.
TEST(MovingCameras, WrongReadingsAreFoundAndRemoved) {
  const unsigned seed = slom::testing::freshSeed();
  SCOPED_TRACE("seed " + std::to_string(seed));
  for (const double line_delay : {0., 3e-5}) {
    SCOPED_TRACE(line_delay);
    app::StereoImuStreamOptions options = quickStream(seed, 9);
    options.line_delay = line_delay;
    MovingRig rig(options, 1);
    rig.stream.camera_offsets = false;
    const std::vector<ImuSample> samples = rig.imu.samples;
    for (std::size_t i = samples.size() / 2; i < samples.size(); ++i)
      rig.imu.samples[i].gyro = vec3(samples[i].gyro + vec3(0.03, -0.04, 0.));
    const StreamResult jumped = rig.fit().result;
    EXPECT_TRUE(jumped.success() && jumped.imus[0].jumps.size() == 1) << joined(jumped.notes);

    rig.imu.samples = samples;
    for (std::size_t i = 1; i < samples.size(); ++i) rig.imu.samples[i].force = samples[i - 1].force;
    const StreamResult late = rig.fit().result;
    ASSERT_TRUE(late.imus[0].force_lag) << joined(late.notes);
    EXPECT_NEAR(late.imus[0].force_lag->value, 5e-3, 1e-3);
    expectErrorsAsStated(rig, late);
  }
}

TEST(MovingCameras, GoodReadingsAreNotDoubted) {
  const unsigned seed = slom::testing::freshSeed();
  const char* const given = std::getenv("SLOM_MOVING_RIGS");
  for (unsigned r = 0; r < unsigned(given ? std::atoi(given) : 1); ++r) {
    SCOPED_TRACE("seed " + std::to_string(seed + r));
    for (const double line_delay : {0., 3e-5}) {
      app::StereoImuStreamOptions options = quickStream(seed + r, 9);
      options.line_delay = line_delay;
      MovingRig rig(options, 1);
      rig.stream.camera_offsets = false;
      const StreamResult result = rig.fit().result;
      const ImuStreamResult& imu = result.imus[0];
      EXPECT_TRUE(result.success() && imu.gross.empty() && imu.jumps.empty() && !imu.force_lag)
          << line_delay << ": " << joined(result.notes);
      EXPECT_EQ(joined(result.doubts), "") << line_delay;
    }
  }
}

/// Expects a DataError with this text.
void expectRefused(const std::function<void()>& call, const std::string& text) {
  try {
    call();
    ADD_FAILURE() << "nothing was thrown instead of: " << text;
  } catch (const DataError& error) {
    EXPECT_STREQ(error.what(), text.c_str());
  }
}

TEST(MovingCameras, FaultsAreNamed) {
  MovingRig one(quickStream(31), 1);
  expectRefused(
      [&] { one.fit(); },
      "[slom.calibration.bad-settings] StreamSettings::camera_offsets: there is one camera only; give "
      "a second one");
  one.stream.camera_offsets = false;
  expectRefused([&] { calibrateMovingCameras(one.data, one.settings, {}, {}); },
                "[slom.calibration.bad-stream] there are no readings; give at least one IMU");
  const testing::Calibrated usual(quickStream(31));
  StreamSettings offsets;
  offsets.camera_offsets = true;
  expectRefused([&] { usual.with({usual.stream()}, offsets); },
                "[slom.calibration.bad-settings] StreamSettings::camera_offsets are estimated by "
                "calibrateMovingCameras(); call it instead");
}

}  // namespace
}  // namespace slom::calibration
