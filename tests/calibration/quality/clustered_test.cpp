// Clustered uncertainty of calibrations: covariances against those of the library's Clustered, which does not use
// camera models; coverage by simulation; and corners with a large leverage against a fit without them. Seeds are fixed.
#include "calibration/quality/uncertainty/clustered.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "calibration/fit/measurements.hpp"
#include "calibration/quality/calibrated_rig.hpp"
#include "calibration/quality/uncertainty/whitened_scores.hpp"
#include "slom/analyze/clustered.hpp"
#include "slom/analyze/student.hpp"

namespace slom::calibration {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using testing::CalibratedRig;
using testing::RigOptions;
using testing::RigTruth;

RigOptions oneCamera(int images) {
  RigOptions options = testing::smallBoards();
  options.cameras = 1;
  options.images = images;
  return options;
}

/// The same fit with each corner as a measurement, in the group of its image, of two images and of its point of the
/// board.
struct Oracle {
  explicit Oracle(const CalibratedRig& rig) {
    Opencv5<> start;
    for (int i = 0; i < Opencv5<>::DOF; ++i)
      start[i] = rig.result.cameras[0].parameters[std::size_t(i)].value;
    camera = est.insertRV(start, true, "camera");
    int index = 0;
    for (const ImageResult& image : rig.result.images) {
      const auto pose = est.insertRV(image.left2world, true, "pose");
      for (const Corner& corner : rig.data.cameras[0].find(image.image)->corners) {
        est.insertMeasurement(
            [](const auto& lens, const auto& left2world, const vec3& world) {
              return CornerInOther()(lens, SE3(), left2world, world);
            },
            camera, pose, corner.world, measured(corner.pixel), StandardDeviation(rig.settings.sigma_px),
            group("image", image.image), group("pair", std::min(index / 2, 9)),
            group("corner", corner.number));
      }
      ++index;
    }
    EXPECT_TRUE(est.optimize().converged);
  }
  Estimator est;
  VarID<Opencv5<>> camera;
};

double largestRelativeDifference(const MatrixXd& a, const MatrixXd& b) {
  const VectorXd scale = b.diagonal().cwiseSqrt().cwiseInverse();
  return (scale.asDiagonal() * (a - b) * scale.asDiagonal()).cwiseAbs().maxCoeff();
}

TEST(ClusteredCalibration, EqualsThatOfTheLibrary) {
  Settings settings;
  const CalibratedRig rig = testing::calibratedRig(oneCamera(21), settings, 4);
  ASSERT_TRUE(rig.result.success());
  const FittedRig fitted(rig.result);
  const WhitenedScores scores(rig.data, fitted);
  const MatrixXd& K = scores.root();
  const Oracle oracle(rig);
  EXPECT_LT(largestRelativeDifference(K * K.transpose(), oracle.est.covariance(oracle.camera)), 1e-4);
  for (const int length : {1, 2}) {
    const Clustered core = slom::clustered(
        oracle.est, {.by = {length == 1 ? "image" : "pair"}, .correction = ClusterCorrection::cr2});
    const GroupSums sums = scores.byBlocks(length);
    EXPECT_EQ(sums.groups, length == 1 ? 21 : 10);
    EXPECT_LT(largestRelativeDifference(K * sums.V * K.transpose(), core.covariance(oracle.camera)), 1e-4);
    const VectorXd dof = core.degreesOfFreedom(oracle.camera);
    for (int i = 0; i < dof.size(); ++i) EXPECT_NEAR(sums.dof[i], dof[i], 1e-3 * dof[i]) << i;
  }
  const BoardPointSums points = scores.byBoardPoints(2);
  const double n = points.points;
  EXPECT_EQ(n, 30);
  const MatrixXd raw = slom::clustered(oracle.est, {.by = {"corner"}, .correction = ClusterCorrection::cr0})
                           .covariance(oracle.camera);
  EXPECT_LT(largestRelativeDifference(K * points.by_point * K.transpose() * ((n - 1) / n), raw), 1e-4);
  EXPECT_GT(points.dof, 15);
  EXPECT_LT(points.dof, 30);
}

/// Returns pixels with noise and with an error that all corners of an image share: each image appears a little larger
/// or smaller than the lens implies. `memory` is the correlation of neighbouring images.
Dataset withSharedErrors(const RigTruth& truth, const RigOptions& options, std::mt19937_64& random,
                         double zoom, double memory) {
  Dataset data = testing::measured(truth, options, random, false);
  std::normal_distribution<> normal;
  double error = normal(random);
  for (View& view : data.cameras[0].views) {
    for (Corner& corner : view.corners)
      corner.pixel += zoom * error * vec2(corner.pixel.x() - 330, corner.pixel.y() - 245);
    error = memory * error + std::sqrt(1 - memory * memory) * normal(random);
  }
  return data;
}

struct Coverage {
  int runs = 0, stated = 0, clustered = 0,
      blocks = 0;                // intervals of 95 % for fx that hold; runs with blocks of images
  double mean_square_ratio = 0;  // clustered over stated variance
};

Coverage simulate(int images, double zoom, double memory, int runs) {
  const RigOptions options = oneCamera(images);
  std::mt19937_64 random(17);
  Coverage coverage;
  for (int run = 0; run < runs; ++run) {
    const RigTruth truth = testing::simulateTruth(options, random);
    const Result result = calibrate(withSharedErrors(truth, options, random, zoom, memory), Settings());
    if (!result.success()) continue;
    const Parameter& fx = result.cameras[0].parameters[0];
    const double error = std::abs(fx.value - truth.cameras[0][0]);
    ++coverage.runs;
    coverage.stated += error < 1.96 * fx.std;
    coverage.clustered += error < studentCritical(0.05, fx.dof) * fx.std_clustered;
    coverage.blocks += result.clustered->block_length > 1;
    coverage.mean_square_ratio += std::pow(fx.std_clustered / fx.std, 2);
  }
  coverage.mean_square_ratio /= coverage.runs;
  return coverage;
}

TEST(ClusteredCalibration, IntervalsHoldWhereImagesShareErrors) {
  const Coverage coverage = simulate(14, 0.012, 0, 300);
  EXPECT_EQ(coverage.runs, 300);
  EXPECT_LT(coverage.stated, 0.75 * coverage.runs);
  EXPECT_GT(coverage.clustered, 0.91 * coverage.runs);
  EXPECT_LT(coverage.clustered, 0.985 * coverage.runs);
}

TEST(ClusteredCalibration, IntervalsHoldWhereErrorsAreIndependent) {
  const Coverage coverage = simulate(14, 0, 0, 300);
  EXPECT_EQ(coverage.runs, 300);
  EXPECT_GT(coverage.stated, 0.92 * coverage.runs);
  EXPECT_GT(coverage.clustered, 0.92 * coverage.runs);
  EXPECT_LT(coverage.clustered, 0.985 * coverage.runs);
  EXPECT_NEAR(coverage.mean_square_ratio, 1, 0.15);
}

// Of 64 images seven are independent here; so few do not suffice for 95 %.
TEST(ClusteredCalibration, IntervalsHoldFarBetterWhereNeighbouringImagesShareErrors) {
  const Coverage coverage = simulate(64, 0.012, 0.8, 100);
  EXPECT_EQ(coverage.runs, 100);
  EXPECT_LT(coverage.stated, 0.5 * coverage.runs);
  EXPECT_GT(coverage.clustered, 0.75 * coverage.runs);
  EXPECT_GT(coverage.blocks, 0.8 * coverage.runs);
}

TEST(ClusteredCalibration, ProjectionAndVerdictTakeItFromTenImagesOn) {
  std::mt19937_64 random(3);
  for (const int images : {9, 12}) {
    const RigOptions options = oneCamera(images);
    const RigTruth truth = testing::simulateTruth(options, random);
    const Dataset data = withSharedErrors(truth, options, random, 0.015, 0);
    Result result = calibrate(data, Settings());
    ASSERT_TRUE(result.success());
    ASSERT_TRUE(result.clustered);
    result.quality = assess(data, Settings(), result);
    const CameraQuality& camera = result.quality->cameras[0];
    const bool is_clustered = images >= 10;
    EXPECT_EQ(result.quality->is_clustered, is_clustered);
    EXPECT_EQ(result.clustered->isReliable(), is_clustered);
    ASSERT_EQ(camera.projection.size(), camera.projection_stated.size());
    if (is_clustered) {
      EXPECT_NE(camera.projection[0].std_px, camera.projection_stated[0].std_px);
    } else {
      EXPECT_EQ(camera.projection[0].std_px, camera.projection_stated[0].std_px);
    }
    const PixelUncertainty uncertainty(data, result);
    const int middle = camera.grid.middle();
    EXPECT_NEAR(uncertainty.at(0, camera.grid.node(middle), camera.projection[0].distance_m)->largestStd(),
                camera.projection[0].std_px[std::size_t(middle)], 1e-9);
  }
}

TEST(ClusteredCalibration, SaysWhatLimitsIt) {
  ClusteredUncertainty clustered;
  clustered.images = 8;
  EXPECT_EQ(
      sentencesOf(clustered),
      (std::vector<std::string>{
          "There are only 8 images: the clustered standard deviations are estimated from as few numbers, "
          "and are as uncertain as their degrees of freedom say. Projection uncertainty and verdict use "
          "the stated ones; from 10 images on, they use the clustered ones."}));
  clustered.images = 15;
  EXPECT_EQ(sentencesOf(clustered),
            (std::vector<std::string>{
                "There are only 15 images, too few to see whether successive images share errors; 16 are "
                "needed."}));
  clustered.images = 16;
  EXPECT_TRUE(sentencesOf(clustered).empty());
  clustered.levels_off = false;
  clustered.block_length = 2;
  clustered.blocks = 8;
  EXPECT_EQ(
      sentencesOf(clustered),
      (std::vector<std::string>{
          "The variances still grow with blocks of 2 successive images (8 blocks): errors are shared over "
          "longer series, and the clustered standard deviations are too small."}));
  clustered.images = 100;
  clustered.block_length = 8;
  clustered.blocks = 12;
  clustered.extrapolation = 4.13;
  EXPECT_EQ(sentencesOf(clustered),
            (std::vector<std::string>{
                "The variances still grow with blocks of 8 successive images (12 blocks): errors are shared "
                "over longer series, for example by a drift or a model that is too simple. The growth is "
                "extrapolated: the clustered standard deviations are 4.1 times those of these blocks, and "
                "rough."}));
}

TEST(ClusteredCalibration, IsNeitherThereNorWrongOfAFitThatFailed) {
  const RigOptions options = oneCamera(12);
  std::mt19937_64 random(5);
  const Dataset data = testing::measured(testing::simulateTruth(options, random), options, random, false);
  Settings settings;
  settings.max_iterations = 1;
  const Result result = calibrate(data, settings);
  ASSERT_FALSE(result.success());
  EXPECT_FALSE(result.clustered);
  EXPECT_TRUE(std::isnan(result.cameras[0].parameters[0].std_clustered));
}

TEST(ClusteredCalibration, IsZeroOfWhatIsFixed) {
  const RigOptions options = oneCamera(12);
  std::mt19937_64 random(6);
  const Dataset data = testing::measured(testing::simulateTruth(options, random), options, random, false);
  Settings settings;
  settings.lens.push_back({"", "k3", 0.01, 0.01});
  const Result result = calibrate(data, settings);
  ASSERT_TRUE(result.success());
  EXPECT_EQ(result.cameras[0].parameters[8].std_clustered, 0);
  EXPECT_TRUE(std::isnan(result.cameras[0].parameters[8].dof));
  EXPECT_GT(result.cameras[0].parameters[7].std_clustered, 0);
}

/// The corner that is farthest from the principal point, and its distance [px].
Corner& farthestCorner(CameraData& camera, int& image) {
  Corner* farthest = nullptr;
  double most = 0;
  for (View& view : camera.views) {
    for (Corner& corner : view.corners) {
      const double radius = std::hypot(corner.pixel.x() - 330, corner.pixel.y() - 245);
      if (radius > most) most = radius, farthest = &corner, image = view.image;
    }
  }
  return *farthest;
}

Settings keepAll() {
  Settings settings;
  settings.robust = Robust::none;
  return settings;
}

/// Few corners. One of them, at the border of an image, is `wrong_by` px too far outside.
struct WrongCorner {
  explicit WrongCorner(double wrong_by) {
    RigOptions options = oneCamera(12);
    options.columns = 5, options.rows = 4, options.square_m = 0.08, options.distance = 0.45;
    std::mt19937_64 random(8);
    good = testing::measured(testing::simulateTruth(options, random), options, random, false);
    data = good;
    Corner& wrong = farthestCorner(data.cameras[0], image);
    const vec2 outwards(wrong.pixel.x() - 330, wrong.pixel.y() - 245);
    wrong.pixel += wrong_by * outwards / outwards.norm();
    corner = wrong;
    without = data;
    exclude(without, {{"a", image, corner.number}});
  }
  /// The residual of the corner in a fit without it [px].
  double errorIn(const Result& result) const {
    const CameraResult& camera = result.cameras[0];
    const auto pose = std::find_if(result.images.begin(), result.images.end(),
                                   [&](const ImageResult& one) { return one.image == image; });
    return (camera.project(pose->left2world.inverse() * corner.world) - corner.pixel).norm();
  }
  Dataset good, data, without;
  Corner corner;
  int image = 0;
};

TEST(GrossCorners, AreSeenWhereTheFitFollowsThem) {
  for (const double wrong_by : {5., 13.}) {
    const WrongCorner wrong(wrong_by);
    EXPECT_TRUE(calibrate(wrong.good, keepAll()).gross.empty());
    const Result result = calibrate(wrong.data, keepAll());
    ASSERT_TRUE(result.success());
    ASSERT_FALSE(result.gross.empty());
    const GrossCorner& found = result.gross.front();
    EXPECT_EQ(found.image, wrong.image);
    EXPECT_EQ(found.number, wrong.corner.number);
    EXPECT_LT(found.error_px, 0.6 * found.error_without_px);  // the fit follows it
    const double error = wrong.errorIn(calibrate(wrong.without, keepAll()));
    EXPECT_NEAR(error, wrong_by, 2);
    // One step from the factor, while the lens bends by several pixels.
    EXPECT_NEAR(found.error_without_px, error, 0.5 * error) << wrong_by;
  }
}

TEST(GrossCorners, DoNotMoveTheFitThatRejectsThem) {
  const WrongCorner wrong(13);
  const Result result = calibrate(wrong.data, Settings()), without = calibrate(wrong.without, Settings());
  ASSERT_TRUE(result.success());
  ASSERT_FALSE(result.rejected.empty());
  EXPECT_LE(result.rejected.size(), 2u);  // a good one may be drawn along
  EXPECT_EQ(result.rejected[0].number, wrong.corner.number);
  EXPECT_EQ(result.rejected[0].image, wrong.image);
  EXPECT_NEAR(result.rejected[0].error_without_px, 13, 2);
  EXPECT_TRUE(result.gross.empty());
  Dataset rest = wrong.data;
  for (const GrossCorner& corner : result.rejected) exclude(rest, {{"a", corner.image, corner.number}});
  const Result same = calibrate(rest, keepAll());
  EXPECT_EQ(result.redundancy, same.redundancy);
  for (std::size_t i = 0; i < 9; ++i) {
    const Parameter& p = result.cameras[0].parameters[i];
    EXPECT_NEAR(p.value, same.cameras[0].parameters[i].value, 1e-3 * p.std) << p.name;
    EXPECT_NEAR(p.value, without.cameras[0].parameters[i].value, p.std) << p.name;
  }
  Result assessed = result;
  assessed.quality = assess(wrong.data, Settings(), result);
  EXPECT_EQ(assessed.quality->cameras[0].residuals.size(), rest.cameras[0].cornerCount());
}

TEST(GrossCorners, AreRejectedHoweverFarOffTheyAre) {
  for (const double wrong_by : {60., 100., 200., 500., 1000., 1e5}) {
    const WrongCorner wrong(wrong_by);
    const Result result = calibrate(wrong.data, Settings()), without = calibrate(wrong.without, Settings());
    ASSERT_TRUE(result.success()) << wrong_by;
    EXPECT_TRUE(result.strays.empty()) << wrong_by;
    ASSERT_FALSE(result.rejected.empty()) << wrong_by;
    EXPECT_EQ(result.rejected[0].number, wrong.corner.number);
    EXPECT_EQ(result.rejected[0].image, wrong.image);
    for (std::size_t i = 0; i < 9; ++i) {
      const Parameter& p = result.cameras[0].parameters[i];
      EXPECT_NEAR(p.value, without.cameras[0].parameters[i].value, p.std) << wrong_by << " " << p.name;
    }
  }
}

TEST(GrossCorners, RejectionLeavesGoodDataAsTheyAre) {
  const WrongCorner wrong(0);
  const Result kept = calibrate(wrong.good, keepAll()), result = calibrate(wrong.good, Settings());
  EXPECT_TRUE(result.rejected.empty());
  for (std::size_t i = 0; i < 9; ++i)
    EXPECT_EQ(result.cameras[0].parameters[i].value, kept.cameras[0].parameters[i].value);
}

/// All corners of a blurred image are worse than those of others. It is no image with gross corners unless it has one.
TEST(GrossCorners, AreThoseBesideTheOthersOfTheirImage) {
  WrongCorner wrong(0);
  std::mt19937_64 random(3);
  std::normal_distribution<> normal(0, 2);
  View& blurred = wrong.data.cameras[0].views[4];
  for (Corner& corner : blurred.corners) corner.pixel += vec2(normal(random), normal(random));
  const Result result = calibrate(wrong.data, Settings());
  ASSERT_TRUE(result.success());
  EXPECT_TRUE(result.rejected.empty());
  EXPECT_TRUE(result.gross.empty());
  blurred.corners[7].pixel += vec2(30., -25.);
  const Result with_one = calibrate(wrong.data, Settings());
  // By itself the corner, or the image as a whole, which is far above what detection explains.
  ASSERT_EQ(with_one.rejected.size() + with_one.strays.size(), 1u);
  if (!with_one.rejected.empty()) {
    EXPECT_EQ(with_one.rejected[0].image, blurred.image);
    EXPECT_EQ(with_one.rejected[0].number, blurred.corners[7].number);
  } else {
    EXPECT_EQ(with_one.strays[0].image, blurred.image);
  }
}

}  // namespace
}  // namespace slom::calibration
