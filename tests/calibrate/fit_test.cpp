// The whole calibration on simulated rigs: exact without noise, whatever is missing or fixed.
#include <algorithm>
#include <cmath>
#include <random>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "calibrate/calibrate_command.hpp"
#include "calibrate/library.hpp"
#include "calibrate/output/notes.hpp"
#include "calibration/fit/imu_precision.hpp"
#include "calibration/rotation_vector.hpp"
#include "calibration/simulated_rig.hpp"

namespace slom::app::calib {
namespace {

using testing::angleBetween;
using testing::RigOptions;
using testing::RigTruth;

struct Calibrated {
  RigTruth truth;
  Dataset data;
  Result result;
};

RigOptions noiseless() {
  RigOptions options;
  options.sigma_px = options.sigma_acc = 0;
  return options;
}

/// Simulates, lets `spoil` take away from the data, and calibrates.
template <class Spoil>
Calibrated run(const RigOptions& options, const Settings& settings, unsigned seed, Spoil spoil) {
  std::mt19937_64 random(seed);
  Calibrated r;
  r.truth = testing::simulateTruth(options, random);
  r.data = testing::simulateMeasurements(r.truth, options, random);
  spoil(r.data);
  r.result = calibrate(r.data, settings);
  return r;
}
Calibrated run(const RigOptions& options, const Settings& settings, unsigned seed) {
  return run(options, settings, seed, [](Dataset&) {});
}

void keepImages(CameraData& camera, int first, int last) {
  std::erase_if(camera.views, [&](const View& v) { return v.image < first || v.image > last; });
}

/// Expects agreement with the truth up to the accuracy of the optimiser.
void expectTruth(const Calibrated& r) {
  ASSERT_TRUE(r.result.success()) << r.result.message << r.result.undetermined;
  for (std::size_t c = 0; c < r.truth.cameras.size(); ++c) {
    const CameraResult& camera = r.result.cameras[c];
    for (std::size_t i = 0; i < camera.parameters.size(); ++i) {
      const double truth = r.truth.cameras[c][Eigen::Index(i)];
      EXPECT_NEAR(camera.parameters[i].value, truth, 1e-5 * camera.parameters[i].std + 1e-9)
          << camera.parameters[i].name;
    }
    EXPECT_LT((camera.left2camera.pos - r.truth.left2camera[c].pos).norm(), 1e-7);
    EXPECT_LT(angleBetween(camera.left2camera.orient, r.truth.left2camera[c].orient), 1e-7);
    EXPECT_LT(camera.rms_px, 1e-5);
  }
  for (const ImageResult& image : r.result.images) {
    EXPECT_LT(angleBetween(image.left2world.orient, r.truth.left2world.at(image.image).orient), 1e-7);
    EXPECT_LT((image.left2world.pos - r.truth.left2world.at(image.image).pos).norm(), 1e-7);
  }
}

void expectImuTruth(const Calibrated& r) {
  ASSERT_TRUE(r.result.imu);
  EXPECT_LT(angleBetween(r.result.imu->left2imu, r.truth.left2imu), 1e-6);
  EXPECT_LT((r.result.imu->acc_bias - r.truth.acc_bias).norm(), 1e-5);
  EXPECT_NEAR(r.result.imu->gravity, r.truth.gravity, 1e-5);
}

TEST(CalibrateFit, FindsTheTruthWithoutNoise) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    const Calibrated r = run(noiseless(), Settings{}, seed);
    expectTruth(r);
    expectImuTruth(r);
  }
}

TEST(CalibrateFit, BoardsWithZDown) {
  RigOptions options = noiseless();
  options.z_down = true;
  const Calibrated r = run(options, Settings{}, 1);
  expectTruth(r);
  expectImuTruth(r);
}

TEST(CalibrateFit, OneCameraWithoutImu) {
  RigOptions options = noiseless();
  options.cameras = 1;
  const Calibrated r = run(options, Settings{}, 2, [](Dataset& data) { data.imu.reset(); });
  expectTruth(r);
  EXPECT_FALSE(r.result.imu);
}

TEST(CalibrateFit, ImagesThatTheReferenceDidNotSee) {
  const Calibrated r = run(noiseless(), Settings{}, 3, [](Dataset& data) {
    keepImages(data.cameras[0], 1, 5);
    keepImages(data.cameras[1], 3, 8);
  });
  expectTruth(r);
  expectImuTruth(r);
  EXPECT_EQ(r.result.images.size(), 8u);
  EXPECT_FALSE(r.result.images.back().rms_px[0]);
  EXPECT_TRUE(r.result.images.back().rms_px[1]);
}

TEST(CalibrateFit, ACameraTiedThroughAnother) {
  RigOptions options = noiseless();
  options.cameras = 3;
  options.images = 10;
  const Calibrated r = run(options, Settings{}, 4, [](Dataset& data) {
    keepImages(data.cameras[0], 1, 5);
    keepImages(data.cameras[2], 6, 10);
  });
  expectTruth(r);
}

TEST(CalibrateFit, RowsOfTheFilesNeedNotPairUp) {
  const Calibrated r = run(noiseless(), Settings{}, 5, [](Dataset& data) {
    for (View& view : data.cameras[1].views) {
      std::reverse(view.corners.begin(), view.corners.end());
      view.corners.resize(view.corners.size() - 7);
      for (std::size_t i = 0; i < view.corners.size(); ++i) view.corners[i].number = int(i);
    }
  });
  expectTruth(r);
}

TEST(CalibrateFit, RadialModelFindsItsTruth) {
  RigOptions options = noiseless();
  options.distorted = false;
  std::mt19937_64 random(6);
  RigTruth truth = testing::simulateTruth(options, random);
  for (auto& camera : truth.cameras) camera[1] = camera[0], camera[4] = -0.15;
  Settings settings;
  settings.model = Model("radial1");
  const Result result = calibrate(testing::simulateMeasurements(truth, options, random), settings);
  ASSERT_TRUE(result.success());
  for (std::size_t c = 0; c < 2; ++c) {
    const auto& p = result.cameras[c].parameters;
    ASSERT_EQ(p.size(), 4u);
    EXPECT_NEAR(p[0].value, truth.cameras[c][0], 1e-6);
    EXPECT_NEAR(p[1].value, truth.cameras[c][2], 1e-6);
    EXPECT_NEAR(p[2].value, truth.cameras[c][3], 1e-6);
    EXPECT_NEAR(p[3].value, -0.15, 1e-9);
  }
}

TEST(CalibrateFit, FixedValuesStayAndHaveNoUncertainty) {
  Settings settings;
  settings.fixed.gravity = 9.7;
  Calibrated r = run(RigOptions{}, settings, 7, [](Dataset& data) {
    for (ImuReading& reading : data.imu->readings) reading.acc = vec3(-reading.acc);
  });
  EXPECT_EQ(r.result.imu->gravity, -9.7);
  EXPECT_EQ(r.result.imu->gravity_std, 0);
  EXPECT_GT(r.result.imu->acc_bias_std.minCoeff(), 0);

  settings.fixed.acc_bias = vec3(0.1, 0.2, 0.3);
  r = run(RigOptions{}, settings, 7);
  EXPECT_EQ(r.result.imu->gravity, 9.7);
  EXPECT_EQ(r.result.imu->acc_bias, vec3(0.1, 0.2, 0.3));
  EXPECT_EQ(r.result.imu->acc_bias_std, vec3());
  EXPECT_GT(r.result.imu->rotation_std.minCoeff(), 0);
}

TEST(CalibrateFit, WhatFixingWouldBringIsWhatItBrings) {
  const Calibrated open = run(RigOptions{}, Settings{}, 8);
  Settings settings;
  settings.fixed.gravity = std::abs(open.result.imu->gravity);
  const Calibrated with_gravity = run(RigOptions{}, settings, 8);
  settings.fixed = Fixed{open.result.imu->acc_bias, {}};
  const Calibrated with_bias = run(RigOptions{}, settings, 8);
  const auto expectEqual = [](const ImuPrecision& a, const ImuPrecision& b) {
    EXPECT_NEAR(a.rotation, b.rotation, 1e-5 * b.rotation);
    EXPECT_NEAR(a.acc_bias, b.acc_bias, 1e-5 * b.acc_bias + 1e-12);
    EXPECT_NEAR(a.gravity, b.gravity, 1e-5 * b.gravity + 1e-7);
  };
  expectEqual(open.result.imu->if_gravity_fixed, with_gravity.result.imu->precision);
  expectEqual(open.result.imu->if_acc_bias_fixed, with_bias.result.imu->precision);
}

TEST(CalibrateFit, TheFiguresOfTheResultAddUp) {
  const Calibrated r = run(RigOptions{}, Settings{}, 9);
  const Result& result = r.result;
  double of_cameras = 0, of_images = 0;
  int measurements = 0;
  for (const CameraResult& camera : result.cameras) {
    of_cameras += std::pow(camera.rms_px / result.sigma_px, 2) * double(camera.corners);
  }
  of_cameras += std::pow(result.imu->rms_acc / result.sigma_acc, 2) * double(result.imu->readings);
  for (const ImageResult& image : result.images) of_images += image.chi2, measurements += image.measurements;
  EXPECT_NEAR(of_cameras, result.rss, 1e-9 * result.rss);
  EXPECT_NEAR(of_images, result.rss, 1e-9 * result.rss);
  EXPECT_EQ(measurements, result.measurements);
  EXPECT_EQ(result.unknowns, 2 * 9 + 6 + 8 * 6 + 7);
  EXPECT_EQ(result.redundancy, result.measurements - result.unknowns);
  EXPECT_NEAR(result.chi2PerDof(), 1, 0.15);
  const auto worst = result.worstImages(5);
  ASSERT_EQ(worst.size(), 5u);
  for (std::size_t i = 1; i < 5; ++i)
    EXPECT_GE(worst[i - 1]->chi2PerMeasurement(), worst[i]->chi2PerMeasurement());
}

TEST(CalibrateFit, UncertaintyIsThatOfTheStatedSigmas) {
  const Calibrated one = run(RigOptions{}, Settings{}, 10);
  Settings doubled;
  doubled.sigma_px *= 2;
  doubled.sigma_acc *= 2;
  const Calibrated two = run(RigOptions{}, doubled, 10);
  for (std::size_t i = 0; i < 9; ++i) {
    const Parameter& a = one.result.cameras[1].parameters[i];
    const Parameter& b = two.result.cameras[1].parameters[i];
    EXPECT_NEAR(b.std, 2 * a.std, 1e-6 * b.std);
    EXPECT_NEAR(b.value, a.value, 1e-4 * a.std);
  }
  EXPECT_NEAR(one.result.rss, 4 * two.result.rss, 1e-8 * one.result.rss);
}

TEST(CalibrateFit, ImagesOfDifferentMomentsAreNamed) {
  RigOptions options;
  options.images = 10;
  const auto r = run(options, Settings{}, 11, [](Dataset& data) {
    data.imu.reset();
    std::swap(data.cameras[1].views[2].corners, data.cameras[1].views[4].corners);
  });
  ASSERT_EQ(r.result.strays.size(), 2u);
  EXPECT_EQ(r.result.strays[0].image, 3);
  EXPECT_EQ(r.result.strays[1].image, 5);
  EXPECT_EQ(r.result.strays[0].camera, "b");
  EXPECT_TRUE(run(options, Settings{}, 11).result.strays.empty());
}

/// Whether a note says all of this.
bool isNoted(const Result& result, const std::vector<std::string>& parts) {
  const std::vector<std::string> all = notes(result);
  return std::any_of(all.begin(), all.end(), [&](const std::string& note) {
    return std::all_of(parts.begin(), parts.end(),
                       [&](const std::string& part) { return note.find(part) != std::string::npos; });
  });
}

TEST(CalibrateFit, ADetectionThatIsAColumnAsideIsNamed) {
  RigOptions options;
  options.images = 10;
  const auto shifted = [&](std::size_t camera) {
    return run(options, Settings{}, 12, [&](Dataset& data) {
      data.imu.reset();
      for (Corner& corner : data.cameras[camera].views[3].corners) corner.world[0] += options.square_m;
    });
  };
  for (const std::size_t camera : {0u, 1u}) {
    const Calibrated r = shifted(camera);
    ASSERT_EQ(r.result.strays.size(), 1u);
    EXPECT_EQ(r.result.strays[0].image, 4);
    EXPECT_TRUE(isNoted(
        r.result, {"Image 4 of camera b contradicts", "image 4 of camera a", "a row or column further."}));
  }
}

TEST(CalibrateFit, ASingleWrongCornerIsNamed) {
  const auto r = run(RigOptions{}, Settings{}, 13, [](Dataset& data) {
    data.imu.reset();
    data.cameras[1].views[2].corners[17].pixel += vec2(6., -5.);
  });
  ASSERT_TRUE(r.result.success());
  const int number = r.data.cameras[1].views[2].corners[17].number;
  EXPECT_TRUE(
      isNoted(r.result, {"One corner was left out of the fit, because the others contradict it: corner " +
                         std::to_string(number) + " of image 3 of camera b (camera.csv:"}));
  Settings settings;
  settings.robust = Robust::none;
  const auto kept = run(RigOptions{}, settings, 13, [](Dataset& data) {
    data.imu.reset();
    data.cameras[1].views[2].corners[17].pixel += vec2(6., -5.);
  });
  EXPECT_TRUE(
      isNoted(kept.result, {"Corner " + std::to_string(number) + " of image 3 of camera b (camera.csv:"}));
  EXPECT_FALSE(isNoted(run(RigOptions{}, Settings{}, 13).result, {"found wrongly"}));
}

TEST(CalibrateFit, StrongDistortionAndLongLensesConverge) {
  for (unsigned seed = 0; seed < 3; ++seed) {
    RigOptions wide;
    wide.focal_length = 220;
    wide.distance = 0.3;
    const Calibrated w = run(wide, Settings{}, seed);
    EXPECT_TRUE(w.result.success());
    EXPECT_NEAR(w.result.chi2PerDof(), 1, 0.15);
    RigOptions few;
    few.images = 3;
    const Calibrated f = run(few, Settings{}, seed, [](Dataset& data) { data.imu.reset(); });
    EXPECT_TRUE(f.result.success());
    EXPECT_NEAR(f.result.chi2PerDof(), 1, 0.25);
  }
}

TEST(RotationVector, StdIsThatOfItsComponents) {
  Eigen::Matrix3d A;
  A << 0.9, 0.2, -0.1, 0.1, 1.3, 0.3, -0.4, 0.2, 0.7;
  const Eigen::Matrix3d covariance = 1e-6 * A * A.transpose();
  for (const double angle : {0.0, 1e-8, 1e-3, 1.0, 3.0}) {
    const vec3 v(vec3(0.6, -0.48, 0.64) * angle);
    const SO3 R = SO3::exp(v);
    Eigen::Matrix3d J;  // by central differences
    for (int i = 0; i < 3; ++i) {
      const vec3 d(1e-5 * Eigen::Vector3d::Unit(i));
      J.col(i) = (SO3::log(R * SO3::exp(d)) - SO3::log(R * SO3::exp(vec3(-d)))) / 2e-5;
    }
    const vec3 expected((J * covariance * J.transpose()).diagonal().cwiseSqrt());
    EXPECT_LT((rotationVectorStd(R, covariance) - expected).norm(), 1e-9) << angle;
  }
}

TEST(ImuPrecision, KnownParametersShrinkTheOthers) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Identity(7, 7) * 2;
  A(6, 3) = A(3, 6) = 1;
  const Eigen::MatrixXd information = A.transpose() * A;
  const Eigen::MatrixXd known = whenKnown(information.inverse(), 6, 1);
  EXPECT_LT((known.topLeftCorner(6, 6) - information.topLeftCorner(6, 6).inverse()).norm(), 1e-12);
  EXPECT_LT(known.row(6).norm(), 1e-12);
}

}  // namespace
}  // namespace slom::app::calib
