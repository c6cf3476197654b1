// The simulated IMU follows the simulated path, corners lie where the board is, and files depend only on the seed.
#include "simulate/stereo_imu_stream.hpp"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <slom/measurements/preintegration.hpp>

#include "simulate/stereo_imu_stream_files.hpp"
#include "support/paths.hpp"
#include "support/run_command.hpp"
#include "support/temporary_folder.hpp"

namespace slom::app {
namespace {

using slom::testing::commandPath;
using slom::testing::readFile;
using slom::testing::TemporaryFolder;
using Vec3 = mtk::vect<3>;

StereoImuStreamOptions withoutNoise(SimulatedMotion motion = SimulatedMotion::full) {
  StereoImuStreamOptions options;
  options.seconds = 3;
  options.sigma_px = 0;
  options.noise = {0, 0, 0, 0};
  options.gyro_bias = options.force_bias = Vec3(0., 0., 0.);
  options.motion = motion;
  options.imu_rate = 1000;
  return options;
}

Vec3 velocityOf(const SimulatedPath& path, const StereoImuStreamOptions& options, double time) {
  const auto placeAt = [&](double t) { return (path(t) * options.cam0_to_imu.inverse()).pos; };
  return Vec3((placeAt(time + 1e-5) - placeAt(time - 1e-5)) / 2e-5);
}

TEST(StereoImuStream, ReadingsAreThoseOfThePath) {
  const StereoImuStreamOptions options = withoutNoise();
  const StereoImuStreamData data = simulateStereoImuStream(options);
  const SimulatedPath path(options, options.motion);
  const ImuSamples samples(data.imu);
  const auto toImuClock = [&](double t) {
    return t + options.time_offset - double(data.imu_epoch_ns - options.epoch_ns) * 1e-9;
  };
  for (const double from : {0.1, 0.7, 1.9}) {
    const double to = from + 0.8;
    const auto poseAt = [&](double t) { return path(t) * options.cam0_to_imu.inverse(); };
    const auto moved = samples.motion(toImuClock(from), toImuClock(to), withoutBias(Vec3(), Vec3()));
    const auto r = moved.residual(poseAt(from), velocityOf(path, options, from), poseAt(to),
                                  velocityOf(path, options, to), data.gravity, to - from);
    EXPECT_LT(r.norm(), 2e-5) << "from " << from << " s: " << r.transpose();
  }
}

/// The camera sees each corner at the time when it reads the corner's row. The camera's clock gives the stamps.
TEST(StereoImuStream, RowsAreReadOneAfterAnother) {
  StereoImuStreamOptions options = withoutNoise();
  options.camera_offset = -0.7;
  options.camera_phase = 0.013;
  options.line_delay = 6e-5;
  const StereoImuStreamData data = simulateStereoImuStream(options);
  const SimulatedPath path(options, options.motion);
  for (int c = 0; c < 2; ++c) {
    ASSERT_FALSE(data.corners[c].empty());
    EXPECT_EQ(data.corners[c].front().time_ns - options.epoch_ns, c == 0 ? 0 : -687'000'000);
    for (const StreamCorner& corner : data.corners[c]) {
      const double stamp = double(corner.time_ns - options.epoch_ns) * 1e-9;
      const double time =
          stamp - (c == 0 ? 0 : options.camera_offset) + options.line_delay * corner.pixel.y();
      const Vec3 in_cam0 = path(time).inverse() * streamCornerInWorld(options, corner.corner);
      const auto seen = c == 0 ? data.cam0.project(in_cam0) : data.cam1.project(data.cam0_to_cam1 * in_cam0);
      ASSERT_LT((seen - corner.pixel).norm(), 1e-6) << "camera " << c << ", corner " << corner.corner;
    }
  }
}

TEST(StereoImuStream, MovesAsAHandDoes) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    StereoImuStreamOptions options = withoutNoise();
    options.seed = seed;
    const StereoImuStreamData data = simulateStereoImuStream(options);
    double rate = 0, least = 1e9, most = 0;
    for (const ImuSample& sample : data.imu) {
      rate = std::max(rate, sample.gyro.norm());
      least = std::min(least, sample.force.norm());
      most = std::max(most, sample.force.norm());
    }
    EXPECT_GT(rate, 0.5) << seed;
    EXPECT_LT(rate, 3) << seed;
    EXPECT_GT(least, 9.8 - 5) << seed;
    EXPECT_LT(most, 9.8 + 5) << seed;
    const std::size_t all = 61 * 144;
    EXPECT_GT(data.corners[0].size(), all / 2) << seed << ": the board is mostly out of view";
  }
}

/// OpenCV's projection, of corners that lie anticlockwise on each tag.
TEST(StereoImuStream, CornersAreSeenFromThePath) {
  const StereoImuStreamOptions options = withoutNoise();
  const StereoImuStreamData data = simulateStereoImuStream(options);
  const SimulatedPath path(options, options.motion);
  const double side = 0.088, pitch = 1.3 * side;
  for (const StreamCorner& corner : data.corners[1]) {
    const int tag = corner.corner / 4, k = corner.corner % 4;
    const Eigen::Vector3d world(tag % 6 * pitch + (k == 1 || k == 2 ? side : 0),
                                tag / 6 * pitch + (k > 1 ? side : 0), 0);
    const auto pose = path(double(corner.time_ns - options.epoch_ns) * 1e-9);
    const Eigen::Matrix3d R = data.cam0_to_cam1.orient.toRotationMatrix();
    const Eigen::Vector3d p =
        R * (pose.orient.toRotationMatrix().transpose() * (world - pose.pos)) + data.cam0_to_cam1.pos;
    const double x = p.x() / p.z(), y = p.y() / p.z(), r2 = x * x + y * y;
    const SimulatedCamera& c = data.cam1;
    const double g = 1 + c.k1 * r2 + c.k2 * r2 * r2 + c.k3 * r2 * r2 * r2;
    EXPECT_NEAR(corner.pixel.x(), c.fx * (x * g + 2 * c.p1 * x * y + c.p2 * (r2 + 2 * x * x)) + c.cx, 1e-6);
    EXPECT_NEAR(corner.pixel.y(), c.fy * (y * g + c.p1 * (r2 + 2 * y * y) + 2 * c.p2 * x * y) + c.cy, 1e-6);
  }
}

TEST(StereoImuStream, OtherMotionsLeaveOutTurns) {
  const auto largestRate = [](SimulatedMotion motion, const Vec3& axis) {
    const StereoImuStreamOptions options = withoutNoise(motion);
    double largest = 0;
    for (const ImuSample& sample : simulateStereoImuStream(options).imu) {
      const Vec3 rate = options.cam0_to_imu.orient.inverse() * sample.gyro;
      largest = std::max(largest, (rate - axis * rate.dot(axis)).norm());
    }
    return largest;
  };
  EXPECT_LT(largestRate(SimulatedMotion::rest, Vec3(0., 0., 0.)), 1e-9);
  EXPECT_LT(largestRate(SimulatedMotion::translation, Vec3(0., 0., 0.)), 1e-9);
  EXPECT_LT(largestRate(SimulatedMotion::one_axis, Vec3(Vec3(0.2, 0.1, 0.9) / std::sqrt(0.86))), 1e-9);
  EXPECT_GT(largestRate(SimulatedMotion::one_axis, Vec3(0., 0., 0.)), 0.2);
}

slom::testing::CommandResult run(const std::filesystem::path& folder, std::vector<std::string> options) {
  std::vector<std::string> words{commandPath().string(), "simulate", "stereo-imu-stream", "--output",
                                 folder.string()};
  words.insert(words.end(), options.begin(), options.end());
  return slom::testing::runCommand(words);
}

TEST(StereoImuStreamCommand, WritesFiveFilesThatDependOnTheSeed) {
  const TemporaryFolder folder;
  const auto first = run(folder / "a", {"--seconds", "2", "--seed", "5"});
  EXPECT_EQ(first.exit_code, 0) << first.errors;
  EXPECT_TRUE(first.output.starts_with("2 s: ")) << first.output;
  ASSERT_EQ(run(folder / "b", {"--seconds", "2", "--seed", "5"}).exit_code, 0);
  ASSERT_EQ(run(folder / "c", {"--seconds", "2", "--seed", "6"}).exit_code, 0);
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "a")) {
    const std::string name = entry.path().filename();
    names.insert(name);
    EXPECT_EQ(readFile(folder / ("a/" + name)), readFile(folder / ("b/" + name))) << name;
    if (name == "imu.yaml") continue;
    EXPECT_NE(readFile(folder / ("a/" + name)), readFile(folder / ("c/" + name))) << name;
  }
  EXPECT_EQ(names, (std::set<std::string>{"cam0_corners.csv", "cam1_corners.csv", "imu.yaml", "imu0.csv",
                                          "truth.json"}));
  EXPECT_TRUE(
      readFile(folder / "a/cam0_corners.csv").starts_with("t_ns,corner,u_px,v_px\n1700000000000000000,"));
  EXPECT_TRUE(readFile(folder / "a/imu0.csv")
                  .starts_with("t_ns,wx_rad_s,wy_rad_s,wz_rad_s,ax_m_s2,ay_m_s2,az_m_s2\n"));
  const auto truth = nlohmann::json::parse(readFile(folder / "a/truth.json"));
  EXPECT_EQ(truth.at("imus").at("imu0").at("time_offset_s").at("value"), 0.0123);
}

TEST(StereoImuStreamCommand, BadOptionsAreNamedWithTheRemedy) {
  const TemporaryFolder folder;
  const auto refuses = [&](const std::string& option, const std::string& value, const std::string& remedy) {
    const auto result = run(folder / "out", {option, value});
    EXPECT_EQ(result.errors, "slom: " + option + " is " + value + "; give " + remedy + "\n");
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_FALSE(std::filesystem::exists(folder / "out"));
  };
  refuses("--seconds", "1.5", "a number of seconds from 2 to 3600");
  refuses("--camera-rate", "0", "a rate from 1 to 10000 Hz");
  refuses("--imu-rate", "200Hz", "a rate from 1 to 10000 Hz");
  refuses("--gyro-noise", "0", "a positive density");
  refuses("--camera-offset", "2e6", "a number of seconds from -1e6 to 1e6");
  refuses("--camera-phase", "1.5", "a number of seconds from -1 to 1");
  refuses("--line-delay", "0.01", "a number of seconds from -1e-3 to 1e-3");
  refuses("--time-offset", "inf", "a number of seconds from -1e6 to 1e6");
  refuses("--motion", "circle", "full, translation, one-axis or rest");
}

}  // namespace
}  // namespace slom::app
