// 200 calibrations of one rig with new noise each time: their statements about themselves are true. Seeds are fixed.
//   parameters    sum of 200 squares of (estimate - truth) / standard deviation
//   projection    a point at rest is projected by each calibration, after the motion of the rig's frame is fitted out
//                 as its definition says, by a separate fit; d^T covariance^-1 d, for pixels in the middle, at the
//                 border and in the corners of both images, at the boards' distance, farther, and at infinity
//   halves        chi-square of the lens parameters; squared difference over its expectation
// Sums of chi-square variables, each within its distribution at a significance of 1e-3.
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "calibration/fit/measurements.hpp"
#include "calibration/quality/calibrated_rig.hpp"
#include "calibration/quality/patterns/split_half.hpp"
#include "support/slow_with_sanitizers.hpp"

namespace slom::calibration {
namespace {

using testing::RigOptions;
using testing::RigTruth;

const int runs = slom::testing::hasSanitizers() ? 20 : 200;
constexpr double normal_quantile = 3.2905;  // 1e-3, two-sided
constexpr double at_infinity = std::numeric_limits<double>::infinity();

/// The motion, from the frame of a calibration to that of the truth, that lets the true cameras see the
/// calibration's boards best where the true boards are.
SE3 motionToTruth(const RigTruth& truth, const Dataset& data, const Result& result) {
  Estimator est;
  const auto motion_back = est.insertRV(SE3(), "motion^-1");
  for (std::size_t c = 0; c < truth.cameras.size(); ++c) {
    for (const ImageResult& image : result.images) {
      const View* view = data.cameras[c].find(image.image);
      if (!view) continue;
      const SE3 true_world2camera = truth.left2camera[c] * truth.left2world.at(image.image).inverse();
      for (const Corner& corner : view->corners) {
        const vec3 in_left = image.left2world.inverse() * corner.world;
        const vec2 pixel = truth.cameras[c].project(true_world2camera * corner.world);
        est.insertMeasurement(CornerInOther(), truth.cameras[c], truth.left2camera[c], motion_back, in_left,
                              measured(pixel), StandardDeviation(0.25));
      }
    }
  }
  EXPECT_TRUE(est.optimize().converged);
  return motion_back->inverse();
}

struct Probe {
  std::size_t camera;
  vec2 pixel;
  double distance_m;
  vec3 ray = vec3(0., 0., 1.);  ///< ray according to the true lens
  double chi2 = 0;

  std::string name() const {
    return ::testing::PrintToString(camera) + ": " + ::testing::PrintToString(pixel.x()) + ", " +
           ::testing::PrintToString(pixel.y()) + " at " + ::testing::PrintToString(distance_m);
  }
};

std::vector<Probe> probesOf(const RigTruth& truth) {
  std::vector<Probe> probes;
  for (std::size_t c = 0; c < truth.cameras.size(); ++c) {
    CameraResult camera;
    camera.model = "opencv5";
    for (const double value : truth.cameras[c]) camera.parameters.push_back({"", value, 1});
    const auto lens = lensOf(camera);
    for (const double distance : {0.7, 2.0, at_infinity}) {
      for (const vec2& pixel : {vec2(320., 240.), vec2(0., 240.), vec2(320., 479.), vec2(0., 0.),
                                vec2(639., 479.), vec2(500., 100.)}) {
        probes.push_back({c, pixel, distance, *lens.unproject(pixel)});
      }
    }
  }
  return probes;
}

void addProjection(Probe& probe, const RigTruth& truth, const FittedRig& rig, const Posterior& posterior,
                   const SE3& motion) {
  const std::size_t c = probe.camera;
  vec3 in_camera;
  if (std::isinf(probe.distance_m)) {
    const vec3 in_left = truth.left2camera[c].orient.inverse() * probe.ray;
    in_camera = rig.left2camera[c].orient * (motion.orient.inverse() * in_left);
  } else {
    const vec3 in_left = truth.left2camera[c].inverse() * vec3(probe.distance_m * probe.ray);
    in_camera = rig.left2camera[c] * (motion.inverse() * in_left);
  }
  const Eigen::Vector2d difference = rig.lenses[c].project(in_camera) - probe.pixel;
  const Eigen::Matrix2d covariance =
      projectedPoint(rig, c, probe.ray, probe.distance_m).covariance(posterior);
  probe.chi2 += difference.dot(covariance.inverse() * difference);
}

TEST(Resimulation, WhatCalibrationsSayOfThemselvesIsTrue) {
  const RigOptions options = testing::smallBoards();
  const Settings settings = testing::opencv4();
  std::mt19937_64 random(5);
  RigTruth truth = testing::simulateTruth(options, random);
  for (auto& camera : truth.cameras) camera[8] = 0;
  std::vector<Probe> probes = probesOf(truth);
  std::map<std::string, double> squares;
  std::vector<double> half_chi2(2), half_square(2);
  int half_dof = 0;
  for (int run = 0; run < runs; ++run) {
    const Dataset data = testing::measured(truth, options, random, false);
    const Result result = calibrate(data, settings);
    ASSERT_TRUE(result.success()) << result.message;
    for (std::size_t c = 0; c < 2; ++c) {
      for (std::size_t i = 0; i < 8; ++i) {
        const Parameter& p = result.cameras[c].parameters[i];
        squares[result.cameras[c].name + "." + p.name] +=
            std::pow((p.value - truth.cameras[c][Eigen::Index(i)]) / p.std, 2);
      }
    }
    const FittedRig rig(result);
    const Posterior posterior(testing::informationOfAll(data, rig));
    const SE3 motion = motionToTruth(truth, data, result);
    for (Probe& probe : probes) addProjection(probe, truth, rig, posterior, motion);

    const SplitHalf halves = splitHalf(data, settings, result, testing::grids(data, 9, 7));
    ASSERT_EQ(halves.why_not, "");
    for (std::size_t c = 0; c < 2; ++c) {
      half_chi2[c] += halves.cameras[c].chi2;
      half_square[c] += std::pow(halves.cameras[c].rms_px / halves.cameras[c].expected_rms_px, 2) / runs;
      half_dof = halves.cameras[c].dof;
    }
  }
  for (const auto& [name, sum] : squares)
    EXPECT_LT(std::abs(testing::normalOfChiSquare(sum, runs)), normal_quantile)
        << name << ": mean square " << sum / runs;
  for (const Probe& probe : probes) {
    EXPECT_LT(std::abs(testing::normalOfChiSquare(probe.chi2, 2 * runs)), normal_quantile)
        << probe.name() << ": mean " << probe.chi2 / (2 * runs);
  }
  EXPECT_EQ(half_dof, 8);
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_LT(std::abs(testing::normalOfChiSquare(half_chi2[c], half_dof * runs)), normal_quantile)
        << half_chi2[c] / (half_dof * runs);
    EXPECT_NEAR(half_square[c], 1, 0.25) << "mean square of the difference over the expected one";
  }
}

}  // namespace
}  // namespace slom::calibration
