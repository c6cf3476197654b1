// 100 simulated calibrations: their statements about their own uncertainty are true. Each (estimate - truth) / standard
// deviation must be a sample of N(0, 1). Seeds are fixed, so the test always passes or always fails.
//   each parameter   sum of 100 squares within the chi-square distribution, and the Kolmogorov-Smirnov distance from
//                    N(0, 1), both at a significance of 1e-3; finds standard deviations off by 30 %
//   all runs         sum of the RSS within the chi-square distribution, significance 1e-3
#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <slom/calibration.hpp>

#include "calibration/simulated_rig.hpp"

namespace slom::calibration {
namespace {

using testing::RigOptions;
using testing::RigTruth;

constexpr int kRuns = 100;
constexpr double significance = 1e-3, kNormalQuantile = 3.2905;  // two-sided

using Samples = std::map<std::string, std::vector<double>>;

void add(Samples& samples, const std::string& name, const vec3& difference, const vec3& std) {
  for (int i = 0; i < 3; ++i) samples[name + "." + "xyz"[i]].push_back(difference[i] / std[i]);
}

void addRun(Samples& samples, const Result& result, const RigTruth& truth) {
  for (std::size_t c = 0; c < truth.cameras.size(); ++c) {
    const CameraResult& camera = result.cameras[c];
    for (std::size_t i = 0; i < camera.parameters.size(); ++i) {
      const Parameter& p = camera.parameters[i];
      samples[camera.name + "." + p.name].push_back((p.value - truth.cameras[c][Eigen::Index(i)]) / p.std);
    }
    if (c == 0) continue;
    add(samples, camera.name + ".translation", vec3(camera.left2camera.pos - truth.left2camera[c].pos),
        camera.translation_std);
    add(samples, camera.name + ".rotation",
        SO3::log(truth.left2camera[c].orient.inverse() * camera.left2camera.orient), camera.rotation_std);
  }
  add(samples, "imu.rotation", SO3::log(truth.left2imu.inverse() * result.imu->left2imu),
      result.imu->rotation_std);
  add(samples, "imu.acc_bias", vec3(result.imu->acc_bias - truth.acc_bias), result.imu->acc_bias_std);
  samples["imu.gravity"].push_back((result.imu->gravity - truth.gravity) / result.imu->gravity_std);
}

/// Standard normal that a chi-square variable corresponds to (Wilson and Hilferty 1931).
double normalOfChiSquare(double chi2, double dof) {
  return (std::cbrt(chi2 / dof) - (1 - 2 / (9 * dof))) / std::sqrt(2 / (9 * dof));
}

/// Largest distance between the distribution of the samples and N(0, 1).
double kolmogorovSmirnov(std::vector<double> z) {
  std::sort(z.begin(), z.end());
  double distance = 0;
  for (std::size_t i = 0; i < z.size(); ++i) {
    const double below = 0.5 * std::erfc(-z[i] / std::sqrt(2.0)), n = double(z.size());
    distance = std::max({distance, below - double(i) / n, double(i + 1) / n - below});
  }
  return distance;
}

TEST(CalibrateStatistics, ErrorsOverTheirStandardDeviationsAreUnitNormal) {
  RigOptions options;
  options.images = 6;
  options.columns = 6;
  options.rows = 5;
  options.square_m = 0.07;
  Settings settings;
  settings.model = Model("opencv4");
  Samples samples;
  double rss = 0, redundancy = 0;
  for (int seed = 0; seed < kRuns; ++seed) {
    std::mt19937_64 random(seed);
    RigTruth truth = testing::simulateTruth(options, random);
    for (auto& camera : truth.cameras) camera[8] = 0;
    const Result result = calibrate(testing::simulateMeasurements(truth, options, random), settings);
    ASSERT_TRUE(result.success()) << "seed " << seed << ": " << result.message;
    addRun(samples, result, truth);
    rss += result.rss;
    redundancy += result.redundancy;
  }
  ASSERT_EQ(samples.size(), 2u * 8 + 6 + 7);
  const double ks_limit = std::sqrt(-0.5 * std::log(significance / 2)) / std::sqrt(double(kRuns));
  for (const auto& [name, z] : samples) {
    double square = 0;
    for (const double value : z) square += value * value;
    EXPECT_LT(std::abs(normalOfChiSquare(square, kRuns)), kNormalQuantile)
        << name << ": mean square " << square / kRuns;
    EXPECT_LT(kolmogorovSmirnov(z), ks_limit) << name;
  }
  EXPECT_LT(std::abs(normalOfChiSquare(rss, redundancy)), kNormalQuantile) << rss << " for " << redundancy;
}

}  // namespace
}  // namespace slom::calibration
