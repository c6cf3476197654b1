// Boards whose shape is estimated with the rest. Planted shapes are found within their standard deviations, and
// statements about the lens hold. Seeds are fixed.
#include "slom/calibration/board_shape.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include <Eigen/QR>
#include <gtest/gtest.h>

#include "calibration/data/board_basis.hpp"
#include "calibration/data/fitted_board.hpp"
#include "calibration/fit/board_corners.hpp"
#include "calibration/quality/calibrated_rig.hpp"
#include "calibration/quality/uncertainty/clustered.hpp"
#include "calibration/quality/uncertainty/whitened_scores.hpp"
#include "slom/analyze/clustered.hpp"
#include "slom/analyze/derivative_check.hpp"
#include "slom/calibration/comparison.hpp"
#include "slom/calibration/pixel_uncertainty.hpp"
#include "support/message_of.hpp"

namespace slom::calibration {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using testing::RigOptions;
using testing::RigTruth;

/// Displacement of a corner from its place in the data.
using Displacement = std::function<vec3(const vec3& world)>;

RigOptions rigOf(int cameras, int images) {
  RigOptions options = testing::smallBoards();
  options.cameras = cameras;
  options.images = images;
  return options;
}

/// Returns the displacement on a board of 6 x 5 corners, 0.35 m x 0.28 m, whose middle is 1 mm above its border.
vec3 bowed(const vec3& world) {
  const double x = (world.x() - 0.175) / 0.175, y = (world.y() - 0.14) / 0.14;
  return vec3(0., 0., 5e-4 * (1 - x * x) + 3e-4 * (1 - y * y) + 2e-4 * x * y);
}

struct Simulation {
  RigTruth truth;
  Dataset data;
};

Simulation simulate(const RigOptions& options, const Displacement& displacement, unsigned seed,
                    bool has_imu = false) {
  std::mt19937_64 random(seed);
  Simulation simulation{testing::simulateTruth(options, random), {}};
  const RigTruth& truth = simulation.truth;
  simulation.data = testing::measured(truth, options, random, has_imu);
  for (std::size_t c = 0; c < simulation.data.cameras.size(); ++c) {
    for (View& view : simulation.data.cameras[c].views) {
      const SE3 world2camera = truth.left2camera[c] * truth.left2world.at(view.image).inverse();
      for (Corner& corner : view.corners) {
        const auto pixel = [&](const vec3& p) { return truth.cameras[c].project(world2camera * p); };
        corner.pixel += pixel(vec3(corner.world + displacement(corner.world))) - pixel(corner.world);
      }
    }
  }
  return simulation;
}

Settings withShape(BoardShape shape) {
  Settings settings;
  settings.board_shape = shape;
  return settings;
}

/// Displacements by corner number.
Displacement scattered(double sigma, std::mt19937_64& random) {
  std::normal_distribution<> normal;
  std::map<std::pair<double, double>, vec3> all;
  for (int k = 0; k < 30; ++k) {
    const double s = testing::smallBoards().square_m;
    all[{s * (k % 6), s * (k / 6)}] = sigma * vec3(normal(random), normal(random), normal(random));
  }
  return [all](const vec3& world) { return all.at({world.x(), world.y()}); };
}

vec3 none(const vec3&) { return vec3(0., 0., 0.); }

/// z^2 of all parameters of all lenses, and of the first camera to the others.
VectorXd squaresOfErrors(const Result& result, const RigTruth& truth) {
  std::vector<double> squares;
  for (std::size_t c = 0; c < result.cameras.size(); ++c) {
    const CameraResult& camera = result.cameras[c];
    for (std::size_t i = 0; i < camera.parameters.size(); ++i) {
      const Parameter& p = camera.parameters[i];
      squares.push_back(std::pow((p.value - truth.cameras[c][Eigen::Index(i)]) / p.std, 2));
    }
    if (c == 0) continue;
    const vec3 turn = SO3::log(truth.left2camera[c].orient.inverse() * camera.left2camera.orient);
    for (const int k : {0, 1, 2}) {
      squares.push_back(
          std::pow((camera.left2camera.pos[k] - truth.left2camera[c].pos[k]) / camera.translation_std[k], 2));
      squares.push_back(std::pow(turn[k] / camera.rotation_std[k], 2));
    }
  }
  return Eigen::Map<VectorXd>(squares.data(), Eigen::Index(squares.size()));
}

double meanSquareOfErrors(const RigOptions& options, BoardShape shape, int runs,
                          const std::function<Displacement(std::mt19937_64&)>& board) {
  std::mt19937_64 random(5);
  double sum = 0, count = 0;
  for (int run = 0; run < runs; ++run) {
    const Simulation simulation = simulate(options, board(random), unsigned(100 + run));
    const Result result = calibrate(simulation.data, withShape(shape));
    EXPECT_TRUE(result.success()) << result.message;
    const VectorXd squares = squaresOfErrors(result, simulation.truth);
    sum += squares.sum();
    count += double(squares.size());
  }
  return sum / count;
}

TEST(BoardShape, AFreeBoardIsFoundWithinItsStandardDeviations) {
  std::mt19937_64 random(2);
  const Displacement planted = scattered(5e-4, random);
  const Simulation simulation = simulate(rigOf(2, 30), planted, 3);
  const Result flat = calibrate(simulation.data, Settings());
  const Result free = calibrate(simulation.data, withShape(BoardShape::free));
  ASSERT_TRUE(free.success()) << free.message;
  EXPECT_GT(flat.chi2PerDof(), 1.5);
  EXPECT_NEAR(free.chi2PerDof(), 1, 0.1);
  ASSERT_TRUE(free.board);
  EXPECT_FALSE(flat.board);
  ASSERT_EQ(free.board->corners.size(), 30u);
  EXPECT_NEAR(free.board->sigma, 5e-4, 1.5e-4);
  // The whole of the board, turned, moved and scaled, is what its standard deviations allow, too, as errors are of each
  // corner.
  double chi2 = 0, square = 0;
  for (const MovedCorner& corner : free.board->corners) {
    const vec3 error(corner.displacement - planted(corner.world));
    chi2 += error.cwiseQuotient(corner.std).squaredNorm();
    square += error.squaredNorm();
  }
  EXPECT_LT(std::sqrt(square / 90), 2.5e-4);
  EXPECT_GT(chi2 / 90, 0.3);
  EXPECT_LT(chi2 / 90, 2.5);
}

TEST(BoardShape, StandardDeviationsOfLensAndRigHold) {
  const auto scatter = [](std::mt19937_64& random) { return scattered(5e-4, random); };
  const auto bow = [](std::mt19937_64&) -> Displacement { return bowed; };
  EXPECT_GT(meanSquareOfErrors(rigOf(2, 16), BoardShape::flat, 6, scatter), 4);
  EXPECT_NEAR(meanSquareOfErrors(rigOf(2, 16), BoardShape::free, 25, scatter), 1, 0.25);
  EXPECT_GT(meanSquareOfErrors(rigOf(2, 16), BoardShape::flat, 6, bow), 2.5);
  EXPECT_NEAR(meanSquareOfErrors(rigOf(2, 16), BoardShape::bent, 25, bow), 1, 0.25);
}

TEST(BoardShape, ABentBoardIsFoundByThreeNumbers) {
  const Simulation simulation = simulate(rigOf(1, 24), bowed, 7);
  const Result result = calibrate(simulation.data, withShape(BoardShape::bent));
  ASSERT_TRUE(result.success()) << result.message;
  EXPECT_EQ(result.unknowns, 9 + 6 * 24 + 3);
  EXPECT_NEAR(result.chi2PerDof(), 1, 0.1);
  EXPECT_EQ(result.board->within_plane, 0);
  // Heights from the plane in the sense of least squares.
  MatrixXd plane(30, 3);
  VectorXd heights(30);
  for (int i = 0; i < 30; ++i) {
    const vec3& p = result.board->corners[std::size_t(i)].world;
    plane.row(i) << 1, p.x(), p.y();
    heights[i] = bowed(p).z();
  }
  const VectorXd planted = heights - plane * plane.householderQr().solve(heights);
  for (int i = 0; i < 30; ++i) {
    const MovedCorner& corner = result.board->corners[std::size_t(i)];
    EXPECT_NEAR(corner.displacement.z(), planted[i], 4 * corner.std.z()) << i;
    EXPECT_LT(corner.std.z(), 1e-4);
    EXPECT_EQ(corner.displacement.head<2>().norm(), 0);
  }
}

TEST(BoardShape, AFlatBoardStaysFlat) {
  const Simulation simulation = simulate(rigOf(2, 20), none, 5);
  const Result flat = calibrate(simulation.data, Settings());
  for (const BoardShape shape : {BoardShape::bent, BoardShape::free}) {
    const Result result = calibrate(simulation.data, withShape(shape));
    ASSERT_TRUE(result.success());
    EXPECT_NEAR(result.chi2PerDof(), flat.chi2PerDof(), 0.05);
    for (std::size_t c = 0; c < 2; ++c) {
      for (std::size_t i = 0; i < 9; ++i) {
        const Parameter &p = result.cameras[c].parameters[i], &of_flat = flat.cameras[c].parameters[i];
        EXPECT_GE(p.std, 0.97 * of_flat.std);  // at other values
        EXPECT_LT(p.std, 4 * of_flat.std) << p.name;
        EXPECT_NEAR(p.value, of_flat.value, 4 * p.std) << p.name;
      }
    }
    for (const MovedCorner& corner : result.board->corners)
      EXPECT_LT(corner.displacement.norm(), 5 * corner.std.norm() + 1e-6);
  }
}

/// The covariance for assessments, from which poses and board are eliminated, equals the estimator's; also with an IMU.
TEST(BoardShape, StatedDeviationsAreThoseOfTheEstimator) {
  std::mt19937_64 random(2);
  const Simulation simulation = simulate(rigOf(2, 14), scattered(3e-4, random), 3, true);
  for (const BoardShape shape : {BoardShape::bent, BoardShape::free}) {
    const Result result = calibrate(simulation.data, withShape(shape));
    ASSERT_TRUE(result.success()) << result.message;
    const FittedRig rig(result);
    const WhitenedScores scores(*DataOnBoard(simulation.data, result.board), rig);
    const VectorXd std = scores.statedCovariance().diagonal().cwiseSqrt();
    for (std::size_t c = 0; c < 2; ++c) {
      for (std::size_t i = 0; i < 9; ++i) {
        const double of_estimator = result.cameras[c].parameters[i].std;
        EXPECT_NEAR(std[rig.columns.lens[c] + Eigen::Index(i)], of_estimator, 1e-6 * of_estimator);
      }
    }
    for (const int k : {0, 1, 2}) {
      EXPECT_NEAR(std[rig.columns.pose[1] + k], result.cameras[1].translation_std[k],
                  1e-6 * result.cameras[1].translation_std[k]);
      EXPECT_NEAR(std[rig.columns.imu + 3 + k], result.imu->acc_bias_std[k],
                  1e-6 * result.imu->acc_bias_std[k]);
    }
    // All groups together have the leverage 1, less that of the priors.
    const GroupSums one = scores.byBlocks(14);
    EXPECT_EQ(one.groups, 1);
  }
}

/// Compares the clustered covariance with that of the library. The library corrects by each measurement's leverage,
/// this code by that of a group's score. Both are unbiased if errors are independent, but the matrices differ.
TEST(BoardShape, ClusteredDeviationsAreThoseOfTheLibrary) {
  std::mt19937_64 random(2);
  const Simulation simulation = simulate(rigOf(1, 30), scattered(3e-4, random), 9);
  Settings settings = withShape(BoardShape::free);
  settings.sigma_board = 5e-3;  // wide: the library takes each prior for a group, here they count as stated
  const Result result = calibrate(simulation.data, settings);
  ASSERT_TRUE(result.success()) << result.message;
  const FittedRig rig(result);
  const WhitenedScores scores(*DataOnBoard(simulation.data, result.board), rig);
  Estimator est;
  const auto camera = est.insertRV(lensOf(result.cameras[0]));
  std::vector<VarID<vec3>> board;
  const BoardBasis basis(BoardShape::free, simulation.data);
  for (int i = 0; i < basis.points(); ++i) {
    board.push_back(est.insertRV(result.board->corners[std::size_t(i)].displacement));
    est.prior(board.back(), vec3(0., 0., 0.), StandardDeviation(result.board->sigma));
  }
  for (const ImageResult& image : result.images) {
    const auto pose = est.insertRV(image.left2world);
    for (const Corner& corner : simulation.data.cameras[0].find(image.image)->corners) {
      est.insertMeasurement(CornerOfShapeInLeft(corner, basis), camera, pose,
                            board[std::size_t(basis.find(corner.world))], StandardDeviation(0.25),
                            group("image", image.image));
    }
  }
  EXPECT_TRUE(est.optimize().converged);
  EXPECT_TRUE(checkDerivatives(est).ok());
  const MatrixXd expected =
      clustered(est, {.by = {"image"}, .correction = ClusterCorrection::cr2}).covariance(camera);
  const MatrixXd K = scores.root(), V = K * scores.byBlocks(1).V * K.transpose();
  for (int i = 0; i < 9; ++i) EXPECT_NEAR(V(i, i), expected(i, i), 0.05 * expected(i, i)) << i;
}

TEST(BoardShape, TheRestOfTheAssessmentIsOnTheFittedBoard) {
  const Simulation simulation = simulate(rigOf(2, 24), bowed, 11);
  Settings settings = withShape(BoardShape::bent);
  Result result = calibrate(simulation.data, settings);
  ASSERT_TRUE(result.success());
  result.quality = assess(simulation.data, settings, result);
  double square = 0, corners = 0;
  for (const CornerResidual& residual : result.quality->cameras[0].residuals) {
    square += residual.residual.squaredNorm();
    ++corners;
  }
  EXPECT_NEAR(std::sqrt(square / corners), result.cameras[0].rms_px, 1e-12);
  for (const ResidualPattern& pattern : result.quality->patterns)
    EXPECT_FALSE(pattern.kind == ResidualPattern::Kind::board_shape && pattern.isFound());
  ASSERT_EQ(result.quality->split_half.cameras.size(), 2u);
  for (const SplitHalfCamera& halves : result.quality->split_half.cameras)
    EXPECT_GT(halves.probability, 0.001);
  const Result flat = calibrate(simulation.data, Settings());
  const vec2 middle(320., 240.);
  EXPECT_GT(PixelUncertainty(simulation.data, result).at(0, middle, 0.7)->largestStd(), 0.01);
  EXPECT_TRUE(flat.success());
}

TEST(BoardShape, GrossCornersAreLeftOutAsOfAFlatBoard) {
  Simulation simulation = simulate(rigOf(2, 20), bowed, 13);
  simulation.data.cameras[1].views[4].corners[7].pixel += vec2(9., -6.);
  const Result result = calibrate(simulation.data, withShape(BoardShape::bent));
  ASSERT_TRUE(result.success());
  ASSERT_EQ(result.rejected.size(), 1u);
  EXPECT_EQ(result.rejected[0].number, simulation.data.cameras[1].views[4].corners[7].number);
  EXPECT_NEAR(result.rejected[0].error_px, std::hypot(9, 6), 1.5);
}

TEST(BoardShape, IsChosenByWhatItPredicts) {
  std::mt19937_64 random(2);
  const auto chosen = [](const Displacement& displacement) {
    const Comparison comparison =
        compareBoardShapes(simulate(rigOf(2, 24), displacement, 17).data, Settings());
    EXPECT_EQ(comparison.trials.size(), 3u);
    for (const ModelTrial& trial : comparison.trials) EXPECT_EQ(trial.failure, "");
    return comparison.chosenTrial().board_shape;
  };
  EXPECT_EQ(chosen(none), BoardShape::flat);
  EXPECT_EQ(chosen(bowed), BoardShape::bent);
  EXPECT_EQ(chosen(scattered(5e-4, random)), BoardShape::free);
}

TEST(BoardShape, TheBendsAreOrthogonalToWhatPosesFollow) {
  const Simulation simulation = simulate(rigOf(1, 3), none, 1);
  const BoardBasis basis(BoardShape::bent, simulation.data);
  ASSERT_EQ(basis.points(), 30);
  MatrixXd heights(30, 3), followed(30, 3);
  for (int i = 0; i < 30; ++i) {
    heights.row(i) = basis.map(i).row(2);
    followed.row(i) << 1, basis.point(i).world.x(), basis.point(i).world.y();
    EXPECT_LT(basis.map(i).topRows(2).norm(), 1e-15);
  }
  EXPECT_LT((heights.transpose() * followed).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT((heights.transpose() * heights / 30 - MatrixXd::Identity(3, 3)).cwiseAbs().maxCoeff(), 1e-12);
}

/// Two rows of corners do not show a bend across them. Only the prior holds it.
TEST(BoardShape, ABendThatTheCornersDoNotHaveStaysAtZero) {
  RigOptions options = rigOf(1, 12);
  options.rows = 2;
  const Simulation simulation = simulate(options, none, 3);
  const BoardBasis basis(BoardShape::bent, simulation.data);
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  for (int i = 0; i < basis.points(); ++i) squares += basis.map(i).row(2).transpose().cwiseAbs2();
  EXPECT_EQ((squares.array() == 0).count(), 1);
  EXPECT_EQ(calibrate(simulation.data, withShape(BoardShape::bent)).undetermined,
            calibrate(simulation.data, Settings()).undetermined);
}

TEST(BoardShape, MistakesAreNamed) {
  const Simulation simulation = simulate(rigOf(1, 12), bowed, 3);
  Settings settings = withShape(BoardShape::free);
  for (const double sigma : {0.0, -1.0, 1e-10, double(NAN)}) {
    settings.sigma_board = sigma;
    EXPECT_THROW(calibrate(simulation.data, settings), DataError) << sigma;
  }
  settings.sigma_board = -1;
  EXPECT_EQ(slom::testing::messageOf([&] { calibrate(simulation.data, settings); }),
            "[slom.calibration.bad-settings] Settings::sigma_board is -1; give a positive number");
  settings.sigma_board = 1e-10;
  EXPECT_EQ(
      slom::testing::messageOf([&] { calibrate(simulation.data, settings); }),
      "[slom.calibration.bad-settings] Settings::sigma_board is 1e-10; give a number from 1e-09 to 1e+06 m");
  settings.sigma_board.reset();
  const Result result = calibrate(simulation.data, settings);
  ASSERT_TRUE(result.success());
  Dataset other = simulation.data;
  for (View& view : other.cameras[0].views) {
    for (Corner& corner : view.corners) corner.world *= 2;
  }
  EXPECT_EQ(
      slom::testing::messageOf([&] { assess(other, settings, result); }),
      "[slom.calibration.no-result] there is nothing to assess: corner 4 of image 1 of a is not on the board of the result; pass the result of "
      "calibrate() with these data and settings");
}

TEST(BoardShape, AGivenStandardDeviationIsKept) {
  const Simulation simulation = simulate(rigOf(1, 12), bowed, 3);
  Settings settings = withShape(BoardShape::free);
  settings.sigma_board = 3e-4;
  const Result result = calibrate(simulation.data, settings);
  ASSERT_TRUE(result.success());
  EXPECT_EQ(result.board->sigma, 3e-4);
}

}  // namespace
}  // namespace slom::calibration
