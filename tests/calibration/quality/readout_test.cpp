// Rolling shutters: a rig on a smooth path whose rows are exposed one after another, each corner at its own time. Seeds
// are fixed.
#include "slom/calibration/readout.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "calibration/data/fitted_board.hpp"
#include "calibration/data/sorted.hpp"
#include "calibration/fit/as_fitted.hpp"
#include "calibration/quality/calibrated_rig.hpp"
#include "calibration/quality/uncertainty/whitened_scores.hpp"
#include "calibration/rotation_vector.hpp"

namespace slom::calibration {
namespace {

using testing::RigOptions;
using testing::RigTruth;

constexpr double image_height = 480;

/// The path about the pose of the first image of the simulation, t in intervals between images.
SE3 poseAt(const SE3& start, double t, double slowness) {
  const auto wave = [&](double size, double period, double phase) {
    return size * std::sin(2 * M_PI * t / (slowness * period) + phase);
  };
  const vec3 turn(wave(0.35, 31, 0.3), wave(0.35, 43, 1.1), wave(0.4, 37, 2.0));
  const vec3 shift(wave(0.05, 29, 0.7), wave(0.05, 41, 1.9), wave(0.06, 47, 0.1));
  // About the middle of the board, which stays in sight.
  const vec3 middle(0.175, 0.14, 0.);
  const SO3 R = SO3::exp(turn);
  return SE3(R * start.orient, vec3(middle + R * vec3(start.pos - middle) + shift));
}

struct Recording {
  RigTruth truth;
  Dataset data;
};

/// `readout`: by camera. The motion between images is that of a chord, by a hundredth shorter than the path, on a path
/// that is slower by a hundredth over the square of the slowness.
Recording recorded(int images, const std::vector<double>& readout, unsigned seed, double slowness = 1) {
  RigOptions options = testing::smallBoards();
  options.cameras = int(readout.size());
  options.images = 2;
  std::mt19937_64 random(seed);
  std::normal_distribution<> normal;
  Recording recording{testing::simulateTruth(options, random), {}};
  const Dataset corners = testing::measured(recording.truth, options, random, false);
  const SE3 start = recording.truth.left2world.at(1);
  recording.truth.left2world.clear();
  for (std::size_t c = 0; c < readout.size(); ++c) {
    CameraData camera = corners.cameras[c];
    camera.views.clear();
    for (int image = 1; image <= images; ++image) {
      View view{image, {}};
      recording.truth.left2world[image] = poseAt(start, image, slowness);
      for (int k = 0; k < options.columns * options.rows; ++k) {
        const vec3 world(options.square_m * (k % options.columns), options.square_m * (k / options.columns),
                         0.);
        vec2 pixel(0., image_height / 2);
        for (int round = 0; round < 20; ++round) {
          const SE3 pose = poseAt(start, image + readout[c] * pixel.y() / image_height, slowness);
          pixel = vec2(
              recording.truth.cameras[c].project(recording.truth.left2camera[c] * (pose.inverse() * world)));
        }
        if (!(pixel.x() > 0 && pixel.x() < 640 && pixel.y() > 0 && pixel.y() < image_height)) continue;
        const double u_error = 0.25 * normal(random);
        const double v_error = 0.25 * normal(random);
        view.corners.push_back({k, world, vec2(pixel + vec2(u_error, v_error))});
      }
      if (view.corners.size() >= 12) camera.views.push_back(std::move(view));
    }
    recording.data.cameras.push_back(std::move(camera));
  }
  return recording;
}

double squareOfLensErrors(const Result& result, const RigTruth& truth) {
  double sum = 0, count = 0;
  for (std::size_t c = 0; c < result.cameras.size(); ++c) {
    for (std::size_t i = 0; i < result.cameras[c].parameters.size(); ++i) {
      const Parameter& p = result.cameras[c].parameters[i];
      sum += std::pow((p.value - truth.cameras[c][Eigen::Index(i)]) / p.std, 2);
      count += 1;
    }
  }
  return sum / count;
}

Settings rolling() {
  Settings settings;
  settings.rolling_shutter = true;
  return settings;
}

TEST(RollingShutter, IsFoundWithItsStandardDeviation) {
  double without = 0, with = 0;
  constexpr int runs = 3;
  for (int run = 0; run < runs; ++run) {
    const std::vector<double> planted{0.3, -0.15};
    const Recording recording = recorded(60, planted, unsigned(3 + run));
    const Result plain = calibrate(recording.data, Settings());
    ASSERT_TRUE(plain.success()) << plain.message;
    const auto trials = compareReadout(recording.data, plain);
    ASSERT_EQ(trials.size(), 2u);
    const Result result = calibrate(recording.data, rolling());
    ASSERT_TRUE(result.success()) << result.message;
    for (std::size_t c = 0; c < 2; ++c) {
      ASSERT_TRUE(trials[c]);
      EXPECT_TRUE(trials[c]->isFound()) << c;
      ASSERT_TRUE(result.cameras[c].readout);
      const Readout& readout = *result.cameras[c].readout;
      EXPECT_NEAR(readout.value, planted[c], 4 * readout.std + 0.02 * std::abs(planted[c])) << c;
      EXPECT_LT(readout.std, 0.02);
      EXPECT_GT(readout.std, 0.0005);
    }
    without += squareOfLensErrors(plain, recording.truth) / runs;
    with += squareOfLensErrors(result, recording.truth) / runs;
    EXPECT_LT(result.rss, 0.8 * plain.rss);
  }
  EXPECT_GT(without, 10);
  EXPECT_LT(with, 2.2);
}

TEST(RollingShutter, StandardDeviationsHoldOnASlowPath) {
  double stated = 0, clustered = 0;
  constexpr int runs = 12;
  for (int run = 0; run < runs; ++run) {
    const Recording recording = recorded(48, {0.3}, unsigned(50 + run), 3);
    const Result result = calibrate(recording.data, rolling());
    ASSERT_TRUE(result.success()) << result.message;
    const Readout& readout = *result.cameras[0].readout;
    stated += std::pow((readout.value - 0.3) / readout.std, 2) / runs;
    clustered += std::pow((readout.value - 0.3) / readout.std_clustered, 2) / runs;
  }
  // Of chi-square with 12 degrees of freedom, 0.1 % is below and above; the clustered ones are those of 12 blocks.
  EXPECT_GT(stated, 0.18);
  EXPECT_LT(stated, 2.8);
  EXPECT_GT(clustered, 0.18);
  EXPECT_LT(clustered, 5);
}

TEST(RollingShutter, IsNotFoundWhereAllRowsAreReadAtOnce) {
  int found = 0;
  double squares = 0;
  constexpr int runs = 10;
  for (int run = 0; run < runs; ++run) {
    const Recording recording = recorded(40, {0}, unsigned(20 + run));
    const Result plain = calibrate(recording.data, Settings());
    const auto trials = compareReadout(recording.data, plain);
    found += trials[0]->isFound() ? 1 : 0;
    const Result result = calibrate(recording.data, rolling());
    ASSERT_TRUE(result.cameras[0].readout);
    squares += std::pow(result.cameras[0].readout->value / result.cameras[0].readout->std, 2) / runs;
    // To first order the step says what the fit finds.
    EXPECT_NEAR(trials[0]->readout.value, result.cameras[0].readout->value,
                0.1 * result.cameras[0].readout->std);
  }
  EXPECT_LE(found, 1);
  EXPECT_GT(squares, 0.2);
  EXPECT_LT(squares, 2.6);
}

/// The standard deviations of the estimator, beside the normal equations of the images, which give the clustered ones and
/// the projection uncertainty. The two ways share nothing but the derivatives of a pixel.
TEST(RollingShutter, IsAnUnknownOfAllUncertainties) {
  for (const BoardShape shape : {BoardShape::flat, BoardShape::free}) {
    const Recording recording = recorded(30, {0.3, -0.15}, 8);
    Settings settings = rolling();
    settings.board_shape = shape;
    const Result result = calibrate(recording.data, settings);
    ASSERT_TRUE(result.success()) << result.message;
    const SortedDataset sorted(recording.data);
    const Dataset seen = asFitted(result, *sorted);
    const DataOnBoard on_board(seen, result.board);
    const FittedRig rig(result);
    const Eigen::VectorXd stated = WhitenedScores(*on_board, rig).statedCovariance().diagonal().cwiseSqrt();
    for (std::size_t c = 0; c < 2; ++c) {
      const CameraResult& camera = result.cameras[c];
      for (std::size_t i = 0; i < camera.parameters.size(); ++i) {
        const double expected = stated[rig.columns.lens[c] + Eigen::Index(i)];
        EXPECT_NEAR(camera.parameters[i].std, expected, 2e-3 * expected) << camera.parameters[i].name;
      }
      EXPECT_NEAR(camera.readout->std, stated[rig.columns.readout[c]], 2e-3 * camera.readout->std);
      EXPECT_GT(camera.readout->std_clustered, 0.3 * camera.readout->std);
      EXPECT_LT(camera.readout->std_clustered, 3 * camera.readout->std);
    }
    Eigen::Vector3d translation_std = result.cameras[1].translation_std;
    EXPECT_LT((stated.segment<3>(rig.columns.pose[1]) - translation_std).norm(),
              2e-3 * translation_std.norm());
  }
}

/// The rotation vector's standard deviations by re-evaluating log(R [+] d), central differences.
TEST(RollingShutter, RotationVectorsFollowByTheirJacobian) {
  const SO3 R = SO3::exp(vec3(0.7, -1.1, 0.4));
  const Eigen::Matrix3d J = rotationVectorJacobian(R);
  constexpr double step = 1e-6;
  for (int i = 0; i < 3; ++i) {
    const vec3 d(step * Eigen::Vector3d::Unit(i)), back(-step * Eigen::Vector3d::Unit(i));
    const Eigen::Vector3d slope = (SO3::log(R * SO3::exp(d)) - SO3::log(R * SO3::exp(back))) / (2 * step);
    EXPECT_LT((J.col(i) - slope).norm(), 1e-8) << i;
  }
}

TEST(RollingShutter, IsNotAskedOfAFitThatFailed) {
  const Recording recording = recorded(8, {0.2}, 4);
  Settings settings = rolling();
  settings.max_iterations = 1;
  const Result result = calibrate(recording.data, settings);
  ASSERT_FALSE(result.success());
  EXPECT_FALSE(result.cameras[0].readout);
  EXPECT_TRUE(compareReadout(recording.data, result).empty());
}

TEST(RollingShutter, GoesWithLossesNoiseAndBoards) {
  const Recording recording = recorded(40, {0.25}, 6);
  Settings settings = rolling();
  settings.robust = Robust::huber;
  settings.sigma_by = SigmaBy::speed;
  settings.board_shape = BoardShape::bent;
  const Result result = calibrate(recording.data, settings);
  ASSERT_TRUE(result.success()) << result.message;
  EXPECT_NEAR(result.cameras[0].readout->value, 0.25, 0.03);
  const Quality quality = assess(recording.data, settings, result);
  EXPECT_TRUE(quality.cut_short.empty()) << quality.cut_short;
  for (const ResidualPattern& pattern : quality.patterns)
    EXPECT_FALSE(pattern.kind == ResidualPattern::Kind::row_readout && pattern.isFound());
}

}  // namespace
}  // namespace slom::calibration
