// The simulator's files agree with its truth, by an independent projection in homogeneous matrices, and depend only on
// the seed.

#include "simulate/stereo_imu.hpp"

#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include <Eigen/Dense>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "simulate/stereo_imu_files.hpp"
#include "support/paths.hpp"
#include "support/temporary_folder.hpp"

namespace slom::app {
namespace {

using Json = nlohmann::json;
using slom::testing::readFile;
using slom::testing::sourcePath;
using slom::testing::TemporaryFolder;

/// Contents of a folder written by the simulator.
struct Files {
  std::vector<std::vector<double>> left, right, imu;  ///< rows of the CSV files
  Json truth;
};

std::vector<std::vector<double>> readTable(const std::filesystem::path& path, const std::string& header) {
  std::istringstream stream(readFile(path));
  std::string line;
  std::getline(stream, line);
  EXPECT_EQ(line, header) << path;
  std::vector<std::vector<double>> rows;
  while (std::getline(stream, line)) {
    std::istringstream fields(line);
    std::vector<double> row;
    for (std::string field; std::getline(fields, field, ',');) row.push_back(std::stod(field));
    rows.push_back(row);
  }
  return rows;
}

Files readFolder(const std::filesystem::path& folder) {
  const std::string corners = "image,corner,world_x_m,world_y_m,world_z_m,u_px,v_px";
  return {readTable(folder / "left_corners.csv", corners), readTable(folder / "right_corners.csv", corners),
          readTable(folder / "imu.csv", "image,ax_m_s2,ay_m_s2,az_m_s2,valid"),
          Json::parse(readFile(folder / "truth.json"))};
}

Files simulate(const StereoImuOptions& options) {
  const TemporaryFolder folder;
  writeStereoImu(simulateStereoImu(options), options, folder.path());
  return readFolder(folder.path());
}

Eigen::Matrix3d rotation(const Json& numbers) {
  Eigen::Matrix3d R;
  for (int i = 0; i < 9; ++i) R(i / 3, i % 3) = numbers.at(static_cast<std::size_t>(i)).get<double>();
  return R;
}

Eigen::Vector3d vector(const Json& numbers) {
  Eigen::Vector3d v;
  for (int i = 0; i < 3; ++i) v[i] = numbers.at(static_cast<std::size_t>(i)).get<double>();
  return v;
}

Eigen::Matrix4d pose(const Json& json) {
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  T.topLeftCorner<3, 3>() = rotation(json.at("rotation"));
  T.topRightCorner<3, 1>() = vector(json.at("translation"));
  return T;
}

/// OpenCV's projection, with the parameters of truth.json.
Eigen::Vector2d project(const Json& camera, const Eigen::Vector4d& point) {
  const auto parameter = [&](const char* name) -> double {
    return camera.at("parameters").at(name).at("value");
  };
  const Eigen::Vector2d p = point.head<2>() / point.z();
  const double r2 = p.squaredNorm();
  const Eigen::Vector2d radial =
      p * (1 + parameter("k1") * r2 + parameter("k2") * r2 * r2 + parameter("k3") * r2 * r2 * r2);
  const double p1 = parameter("p1"), p2 = parameter("p2"), xy = p.x() * p.y();
  const Eigen::Vector2d tangential(2 * p1 * xy + p2 * (r2 + 2 * p.x() * p.x()),
                                   p1 * (r2 + 2 * p.y() * p.y()) + 2 * p2 * xy);
  const Eigen::Vector2d image = radial + tangential;
  return {parameter("fx") * image.x() + parameter("cx"), parameter("fy") * image.y() + parameter("cy")};
}

std::string imageKey(const std::vector<double>& row) { return std::to_string(static_cast<int>(row[0])); }

/// Measured minus true coordinates of one camera, u and v in turn [px].
std::vector<double> pixelErrors(const Files& files, const std::string& camera) {
  const Json& json = files.truth.at("cameras").at(camera);
  std::vector<double> errors;
  for (const auto& row : camera == "left" ? files.left : files.right) {
    const Eigen::Matrix4d left2world = pose(files.truth.at("left2world").at(imageKey(row)));
    const Eigen::Matrix4d left2camera = pose(json.at("pose_from_left"));
    const Eigen::Vector4d world(row[2], row[3], row[4], 1);
    const Eigen::Vector2d expected = project(json, left2camera * left2world.inverse() * world);
    errors.push_back(row[5] - expected.x());
    errors.push_back(row[6] - expected.y());
  }
  return errors;
}

/// Measured minus true accelerations of the valid readings [m/s^2].
std::vector<double> accelerationErrors(const Files& files) {
  const Json& imu = files.truth.at("imu");
  std::vector<double> errors;
  for (const auto& row : files.imu) {
    if (row[4] == 0) continue;
    const Eigen::Matrix3d left2world =
        rotation(files.truth.at("left2world").at(imageKey(row)).at("rotation"));
    const Eigen::Vector3d expected = rotation(imu.at("rotation_from_left")) * left2world.transpose() *
                                         Eigen::Vector3d(0, 0, imu.at("gravity").get<double>()) +
                                     vector(imu.at("acc_bias"));
    for (int axis = 0; axis < 3; ++axis)
      errors.push_back(row[static_cast<std::size_t>(axis) + 1] - expected[axis]);
  }
  return errors;
}

/// Expects that mean and chi-square of `errors` are those of normal noise of deviation `sigma`, within four standard
/// deviations.
void expectNormal(const std::vector<double>& errors, double sigma, const std::string& what) {
  const double n = static_cast<double>(errors.size());
  double sum = 0, chi2 = 0;
  for (const double error : errors) {
    sum += error / sigma;
    chi2 += error * error / (sigma * sigma);
  }
  EXPECT_LT(std::abs(sum), 4 * std::sqrt(n)) << what << ": the mean of " << n << " errors is not zero";
  EXPECT_LT(std::abs(chi2 - n), 4 * std::sqrt(2 * n))
      << what << ": chi-square " << chi2 << " of " << n << " errors";
}

double largest(const std::vector<double>& errors) {
  double result = 0;
  for (const double error : errors) result = std::max(result, std::abs(error));
  return result;
}

TEST(StereoImu, NoiseHasTheStatedDeviations) {
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
    const Files files = simulate({.seed = seed, .images = 60, .sigma_px = 0.4, .sigma_acc = 0.03});
    const std::string name = "seed " + std::to_string(seed);
    expectNormal(pixelErrors(files, "left"), 0.4, name + " left");
    expectNormal(pixelErrors(files, "right"), 0.4, name + " right");
    expectNormal(accelerationErrors(files), 0.03, name + " imu");
  }
}

TEST(StereoImu, WithoutNoiseIsExactToTheWrittenDigits) {
  const Files files = simulate({.images = 30, .sigma_px = 0, .sigma_acc = 0});
  EXPECT_LT(largest(pixelErrors(files, "left")), 1e-9);
  EXPECT_LT(largest(pixelErrors(files, "right")), 1e-9);
  EXPECT_LT(largest(accelerationErrors(files)), 1e-9);
}

TEST(StereoImu, SeedDecidesViewsAndNoise) {
  const Files one = simulate({.seed = 1}), again = simulate({.seed = 1}), two = simulate({.seed = 2});
  EXPECT_EQ(one.left, again.left);
  EXPECT_EQ(one.right, again.right);
  EXPECT_EQ(one.imu, again.imu);
  EXPECT_EQ(one.truth, again.truth);
  EXPECT_NE(one.truth.at("left2world"), two.truth.at("left2world"));
  EXPECT_NE(pixelErrors(one, "left")[0], pixelErrors(two, "left")[0]);
  EXPECT_EQ(one.truth.at("cameras"), two.truth.at("cameras")) << "the device is always the same";
}

TEST(StereoImu, NoiseDoesNotChangeTheViews) {
  const Files quiet = simulate({.sigma_px = 0, .sigma_acc = 0}),
              loud = simulate({.sigma_px = 2, .sigma_acc = 1});
  EXPECT_EQ(quiet.truth.at("left2world"), loud.truth.at("left2world"));
  EXPECT_EQ(quiet.left.size(), loud.left.size());
}

TEST(StereoImu, ViewsAreTiltedBy20To50DegreesOnAllSides) {
  const StereoImuData data = simulateStereoImu({.images = 40});
  std::set<int> octants;
  for (const auto& left2world : data.truth.left2world) {
    const mtk::vect<3> towards_camera = left2world.orient * mtk::vect<3>(0.0, 0.0, -1.0);
    const double tilt_deg = std::acos(towards_camera.z()) * 180 / M_PI;
    EXPECT_GE(tilt_deg, 20);
    EXPECT_LE(tilt_deg, 50);
    octants.insert(
        static_cast<int>(std::floor(std::atan2(towards_camera.y(), towards_camera.x()) / (M_PI / 4))));
  }
  EXPECT_EQ(octants.size(), 8u);
}

TEST(StereoImu, CornersFillBothImages) {
  const StereoImuOptions options{.images = 12, .sigma_px = 0};
  const StereoImuData data = simulateStereoImu(options);
  for (const auto* corners : {&data.left, &data.right}) {
    std::set<std::pair<int, int>> cells;  // cells of a grid of 8 x 6 over the image
    for (const SimulatedCorner& corner : *corners) {
      ASSERT_GE(corner.pixel.x(), 0);
      ASSERT_LE(corner.pixel.x(), 1279);
      ASSERT_GE(corner.pixel.y(), 0);
      ASSERT_LE(corner.pixel.y(), 959);
      cells.emplace(static_cast<int>(corner.pixel.x() / 160), static_cast<int>(corner.pixel.y() / 160));
    }
    EXPECT_GE(cells.size(), 40u) << "of 48 cells";
  }
}

TEST(StereoImu, SomeImagesAreSeenByOneCameraAndSomeReadingsAreMissing) {
  const Files files = simulate({});
  std::set<double> left, right;
  for (const auto& row : files.left) left.insert(row[0]);
  for (const auto& row : files.right) right.insert(row[0]);
  EXPECT_EQ(left, (std::set<double>{1, 2, 3, 4, 6, 7, 8, 9, 10, 12}));
  EXPECT_EQ(right, (std::set<double>{1, 2, 3, 5, 6, 7, 8, 9, 11, 12}));
  ASSERT_EQ(files.imu.size(), 12u);
  for (const auto& row : files.imu) {
    const bool missing = row[0] == 3 || row[0] == 8;
    EXPECT_EQ(row[4], missing ? 0 : 1) << "image " << row[0];
    if (missing) {
      EXPECT_EQ(row[1], 0);
    }
  }
}

/// data/simulated_stereo_imu is the output of the simulator. The machine's sin, cos and log may differ in the last
/// digit, so files are not compared byte by byte.
TEST(StereoImu, StoredDataAreItsOutput) {
  const Files stored = readFolder(sourcePath("data/simulated_stereo_imu")), made = simulate({});
  const auto expect_same_table = [](const auto& a, const auto& b, const std::string& what) {
    ASSERT_EQ(a.size(), b.size()) << what;
    for (std::size_t i = 0; i < a.size(); ++i) {
      ASSERT_EQ(a[i].size(), b[i].size()) << what << " row " << i + 1;
      for (std::size_t j = 0; j < a[i].size(); ++j)
        EXPECT_NEAR(a[i][j], b[i][j], 1.5e-9) << what << " row " << i + 1;
    }
  };
  expect_same_table(stored.left, made.left, "left");
  expect_same_table(stored.right, made.right, "right");
  expect_same_table(stored.imu, made.imu, "imu");
  const Json flat_stored = stored.truth.flatten(), flat_made = made.truth.flatten();
  ASSERT_EQ(flat_stored.size(), flat_made.size());
  for (const auto& [key, value] : flat_stored.items()) {
    ASSERT_TRUE(flat_made.contains(key)) << key;
    if (value.is_number()) {
      EXPECT_NEAR(value.get<double>(), flat_made.at(key).get<double>(), 1e-12) << key;
    } else {
      EXPECT_EQ(value, flat_made.at(key)) << key;
    }
  }
}

}  // namespace
}  // namespace slom::app
