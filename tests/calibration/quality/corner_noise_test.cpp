// Noise that differs between corners: losses, growth with speed, slant or distance, and its effect on all statements
// about a calibration. Simulations with fixed seeds.
#include "slom/calibration/corner_noise.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include <gtest/gtest.h>

#include "calibration/data/fitted_board.hpp"
#include "calibration/data/view_facts.hpp"
#include "calibration/fit/as_fitted.hpp"
#include "calibration/fit/measurements.hpp"
#include "calibration/median.hpp"
#include "calibration/models/opencv.hpp"
#include "calibration/procedure/corner_noise.hpp"
#include "calibration/quality/calibrated_rig.hpp"
#include "calibration/quality/uncertainty/whitened_scores.hpp"
#include "slom/calibration/pixel_uncertainty.hpp"
#include "support/message_of.hpp"

namespace slom::calibration {
namespace {

using testing::RigOptions;
using testing::RigTruth;

RigOptions imagesOf(int cameras, int images) {
  RigOptions options = testing::smallBoards();
  options.cameras = cameras;
  options.images = images;
  return options;
}

/// A rig and its images without noise.
struct Scene {
  explicit Scene(const RigOptions& options, unsigned seed) : random(seed) {
    truth = testing::simulateTruth(options, random);
    RigOptions exact = options;
    exact.sigma_px = 0;
    data = testing::measured(truth, exact, random, false);
  }

  std::mt19937_64 random;
  RigTruth truth;
  Dataset data;
};

/// Noise of a corner of the v-th view of a camera [px].
using SigmaOf = std::function<double(std::size_t camera, std::size_t v)>;

Dataset noisy(const Dataset& exact, const SigmaOf& sigma, std::mt19937_64& random) {
  std::normal_distribution<> normal;
  Dataset data = exact;
  for (std::size_t c = 0; c < data.cameras.size(); ++c) {
    for (std::size_t v = 0; v < data.cameras[c].views.size(); ++v) {
      for (Corner& corner : data.cameras[c].views[v].corners) {
        const double u_error = sigma(c, v) * normal(random);
        const double v_error = sigma(c, v) * normal(random);
        corner.pixel += vec2(u_error, v_error);
      }
    }
  }
  return data;
}

/// Moves one corner of `every` by some pixels, in any direction.
void spoil(Dataset& data, int every, double error_px, std::mt19937_64& random) {
  std::uniform_real_distribution<> turn(0, 2 * M_PI);
  int k = 0;
  for (CameraData& camera : data.cameras) {
    for (View& view : camera.views) {
      for (Corner& corner : view.corners) {
        if (++k % every != 0) continue;
        const double angle = turn(random);
        corner.pixel += error_px * vec2(std::cos(angle), std::sin(angle));
      }
    }
  }
}

Settings with(Robust robust, SigmaBy by = SigmaBy::constant) {
  Settings settings;
  settings.robust = robust;
  settings.sigma_by = by;
  return settings;
}

double squareOfErrors(const Result& result, const RigTruth& truth, double Parameter::*std) {
  double sum = 0, count = 0;
  for (std::size_t c = 0; c < result.cameras.size(); ++c) {
    for (std::size_t i = 0; i < result.cameras[c].parameters.size(); ++i) {
      const Parameter& p = result.cameras[c].parameters[i];
      sum += std::pow((p.value - truth.cameras[c][Eigen::Index(i)]) / (p.*std), 2);
      count += 1;
    }
  }
  return sum / count;
}

/// Chi-square of the errors of all lenses, with their stated covariance.
double chiSquareOfErrors(const Result& result, const Dataset& data, const RigTruth& truth) {
  const Dataset weighted = withNoiseOf(result, data);
  const FittedRig rig(result);
  const Eigen::MatrixXd C = WhitenedScores(weighted, rig).statedCovariance();
  std::vector<int> columns;
  std::vector<double> errors;
  for (std::size_t c = 0; c < result.cameras.size(); ++c) {
    for (int i = 0; i < 9; ++i) {
      columns.push_back(rig.columns.lens[c] + i);
      errors.push_back(result.cameras[c].parameters[std::size_t(i)].value - truth.cameras[c][i]);
    }
  }
  const Eigen::VectorXd e = Eigen::Map<const Eigen::VectorXd>(errors.data(), Eigen::Index(errors.size()));
  const Eigen::VectorXd scale = C(columns, columns).diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlations = scale.asDiagonal() * C(columns, columns) * scale.asDiagonal();
  const Eigen::VectorXd scaled = scale.cwiseProduct(e);
  return scaled.dot(correlations.ldlt().solve(scaled));
}

// The oracle has the library's losses on single corners, at the noise that the result names.
TEST(CornerNoise, LossesAreThoseOfTheLibrary) {
  for (const Robust robust : {Robust::huber, Robust::cauchy}) {
    Scene scene(imagesOf(1, 10), 3);
    Dataset data = noisy(
        scene.data, [](auto, auto) { return 0.3; }, scene.random);
    spoil(data, 15, 3, scene.random);
    const Result result = calibrate(data, with(robust));
    ASSERT_TRUE(result.success()) << result.message;
    ASSERT_TRUE(result.downweighted);
    EXPECT_EQ(result.downweighted->loss, robust == Robust::huber ? "Huber(1.5)" : "Cauchy(2.55)");
    EXPECT_NEAR(result.downweighted->noise_px, 0.3, 0.05);
    const Loss loss = robust == Robust::huber ? Loss(Huber(1.5)) : Loss(Cauchy(2.55));

    Estimator est;
    Opencv5<> start;
    for (int i = 0; i < 9; ++i) start[i] = result.cameras[0].parameters[std::size_t(i)].value;
    start[0] += 3, start[4] += 0.01;
    const auto camera = est.insertRV(start);
    for (const View& view : data.cameras[0].views) {
      const auto image = std::find_if(result.images.begin(), result.images.end(),
                                      [&](const ImageResult& one) { return one.image == view.image; });
      const auto pose = est.insertRV(image->left2world);
      for (const Corner& corner : view.corners) {
        est.insertMeasurement(
            [](const auto& lens, const auto& left2world, const Corner& seen) {
              const auto in_left = left2world.orient.inverse() * (seen.world - left2world.pos);
              return decltype(lens.project(in_left))(lens.project(in_left) - seen.pixel);
            },
            camera, pose, corner, StandardDeviation(result.downweighted->noise_px), loss);
      }
    }
    ASSERT_TRUE(est.optimize().converged);
    for (int i = 0; i < 9; ++i) {
      const Parameter& p = result.cameras[0].parameters[std::size_t(i)];
      EXPECT_NEAR(p.value, (*camera)[i], 0.01 * p.std) << p.name;
    }
  }
}

// One corner of twelve is wrong by 2 px, 8 standard deviations: too little for its rejection.
TEST(CornerNoise, LossesHoldAgainstErrorsTooSmallToBeRejected) {
  double none = 0, huber = 0, cauchy = 0, held = 0;
  constexpr int runs = 12;
  for (int run = 0; run < runs; ++run) {
    Scene scene(imagesOf(1, 24), unsigned(40 + run));
    Dataset data = noisy(
        scene.data, [](auto, auto) { return 0.25; }, scene.random);
    spoil(data, 12, 2, scene.random);
    const auto error = [&](Robust robust, double* by_clustered = nullptr) {
      const Result result = calibrate(data, with(robust));
      EXPECT_TRUE(result.success()) << result.message;
      if (by_clustered) *by_clustered += squareOfErrors(result, scene.truth, &Parameter::std_clustered);
      Result clean = calibrate(noisy(
                                   scene.data, [](auto, auto) { return 0.25; }, scene.random),
                               Settings());
      for (std::size_t i = 0; i < clean.cameras[0].parameters.size(); ++i)
        clean.cameras[0].parameters[i].value = result.cameras[0].parameters[i].value;
      return squareOfErrors(clean, scene.truth, &Parameter::std);
    };
    none += error(Robust::none) / runs;
    huber += error(Robust::huber) / runs;
    cauchy += error(Robust::cauchy, &held) / runs;
  }
  // In squares of the standard deviations of data without such errors.
  EXPECT_LT(huber, 0.7 * none);
  EXPECT_LT(cauchy, 0.5 * none);
  EXPECT_LT(cauchy, 2);
  EXPECT_NEAR(held / runs, 1, 0.5);
}

TEST(CornerNoise, AGrossCornerHardlyCounts) {
  Scene scene(imagesOf(2, 10), 8);
  const Dataset good = noisy(
      scene.data, [](auto, auto) { return 0.25; }, scene.random);
  for (const double error_px : {13.0, 1e5}) {
    Dataset bad = good;
    bad.cameras[0].views[4].corners[0].pixel.x() += error_px;
    const Result without = calibrate(good, with(Robust::cauchy)),
                 result = calibrate(bad, with(Robust::cauchy));
    ASSERT_TRUE(result.success()) << result.message;
    EXPECT_EQ(result.rejected.size(), error_px > 1000 ? 1u : 0u);
    for (std::size_t i = 0; i < 9; ++i) {
      const Parameter &a = without.cameras[0].parameters[i], &b = result.cameras[0].parameters[i];
      EXPECT_NEAR(a.value, b.value, 0.3 * a.std) << error_px << " " << a.name;
    }
  }
}

// The noise that is planted follows the formula of CornerNoise, by the quantity as the data without noise have it.
TEST(CornerNoise, GrowthIsFound) {
  constexpr double planted = 8;
  for (const SigmaBy by : {SigmaBy::speed, SigmaBy::slant}) {
    int chosen = 0;
    double growth = 0, held = 0, upper = 0;
    constexpr int runs = 6;
    for (int run = 0; run < runs; ++run) {
      Scene scene(imagesOf(2, 40), unsigned(10 + run));
      std::vector<std::vector<double>> x(2);
      for (std::size_t c = 0; c < 2; ++c) {
        const CameraData& camera = scene.data.cameras[c];
        const std::vector<ViewMotion> motions = motionsOf(camera);
        for (std::size_t v = 0; v < camera.views.size(); ++v) {
          const ViewGeometry seen = geometryOf(
              camera.views[v],
              scene.truth.left2camera[c] * scene.truth.left2world.at(camera.views[v].image).inverse(),
              Eigen::Vector3d::UnitZ());
          x[c].push_back(by == SigmaBy::speed   ? motions[v].speed
                         : by == SigmaBy::slant ? seen.slant
                                                : seen.distance);
        }
      }
      const auto sigma = [&](std::size_t c, std::size_t v) {
        return 0.1 * std::sqrt(1 + planted * std::pow(x[c][v] / medianOf(x[c]), 2));
      };
      const Dataset data = noisy(scene.data, sigma, scene.random);
      const Result plain = calibrate(data, with(Robust::none));
      chosen += compareNoise(data, plain).chosen == by ? 1 : 0;
      Settings settings = with(Robust::none, by);
      const Result first = calibrate(data, settings);
      ASSERT_TRUE(first.success()) << first.message;
      settings.sigma_px *= std::sqrt(first.chi2PerDof());
      const Result result = calibrate(data, settings);
      EXPECT_NEAR(result.chi2PerDof(), 1, 0.01);
      held += chiSquareOfErrors(result, data, scene.truth);
      for (std::size_t c = 0; c < 2; ++c) {
        const CornerNoise& noise = result.cameras[c].noise;
        growth += std::log(noise.growth / planted) / (2 * runs);
        // What it says about sigmas of views is what was planted, but for the factor.
        std::vector<double> ratios;
        for (std::size_t v = 0; v < x[c].size(); ++v)
          ratios.push_back(std::log(settings.sigma_px * noise.at(x[c][v]) / sigma(c, v)));
        upper = std::max(upper, std::abs(*std::max_element(ratios.begin(), ratios.end())));
        upper = std::max(upper, std::abs(*std::min_element(ratios.begin(), ratios.end())));
      }
    }
    EXPECT_GE(chosen, 5) << toString(by);
    EXPECT_NEAR(growth, 0, 1.2) << toString(by);
    EXPECT_LT(upper, 0.5) << toString(by);
    EXPECT_LT(std::abs(testing::normalOfChiSquare(held, 18 * runs)), 3.5) << toString(by);
  }
}

TEST(CornerNoise, ConstantNoiseIsSaidToBeConstant) {
  int wrong = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    Scene scene(imagesOf(1, 24), 70 + seed);
    const Dataset data = noisy(
        scene.data, [](auto, auto) { return 0.25; }, scene.random);
    const Result result = calibrate(data, Settings());
    const NoiseComparison comparison = compareNoise(data, result);
    ASSERT_EQ(comparison.trials.size(), 4u);
    wrong += comparison.chosen == SigmaBy::constant ? 0 : 1;
  }
  EXPECT_LE(wrong, 2);
}

// Twice the sigma of each corner is twice sigma_px.
TEST(CornerNoise, SigmasOfCornersScaleSigmaPx) {
  for (const BoardShape shape : {BoardShape::flat, BoardShape::free}) {
    Scene scene(imagesOf(2, 8), 5);
    Dataset data = noisy(
        scene.data, [](auto, auto) { return 0.25; }, scene.random);
    Settings settings;
    settings.board_shape = shape;
    settings.sigma_board = shape == BoardShape::free ? std::optional(0.001) : std::nullopt;
    settings.sigma_px = 0.5;
    const Result expected = calibrate(data, settings);
    for (CameraData& camera : data.cameras) {
      for (View& view : camera.views) {
        for (Corner& corner : view.corners) corner.sigma = 2;
      }
    }
    settings.sigma_px = 0.25;
    const Result result = calibrate(data, settings);
    EXPECT_NEAR(result.rss, expected.rss, 1e-6 * expected.rss);
    for (std::size_t i = 0; i < 9; ++i) {
      const Parameter &a = expected.cameras[1].parameters[i], &b = result.cameras[1].parameters[i];
      EXPECT_NEAR(b.value, a.value, 1e-4 * a.std) << a.name;
      EXPECT_NEAR(b.std, a.std, 1e-6 * a.std) << a.name;
      EXPECT_NEAR(b.std_clustered, a.std_clustered, 1e-4 * a.std_clustered) << a.name;
    }
    const auto pixel = [&](const Result& of, const Dataset& seen) {
      return PixelUncertainty(seen, of).at(0, vec2(30., 40.), 2)->largestStd();
    };
    EXPECT_NEAR(pixel(result, data), pixel(expected, scene.data), 0.02 * pixel(result, data));
  }
}

// What is said of the quality has the same noise as the fit: its covariance is the estimator's.
TEST(CornerNoise, AssessmentKnowsTheNoise) {
  for (const BoardShape shape : {BoardShape::flat, BoardShape::free}) {
    Scene scene(imagesOf(2, 12), 6);
    Dataset data = noisy(
        scene.data, [](auto, auto v) { return v % 3 == 0 ? 0.6 : 0.2; }, scene.random);
    spoil(data, 30, 2, scene.random);
    Settings settings = with(Robust::cauchy, SigmaBy::speed);
    settings.board_shape = shape;
    const Result result = calibrate(data, settings);
    ASSERT_TRUE(result.success()) << result.message;
    const Dataset weighted = withNoiseOf(result, data);
    const DataOnBoard on_board(weighted, result.board);
    const FittedRig rig(result);
    const Eigen::MatrixXd C = WhitenedScores(*on_board, rig).statedCovariance();
    for (std::size_t c = 0; c < 2; ++c) {
      for (std::size_t i = 0; i < 9; ++i) {
        const Parameter& p = result.cameras[c].parameters[i];
        const auto column = Eigen::Index(rig.columns.lens[c]) + Eigen::Index(i);
        EXPECT_NEAR(std::sqrt(C(column, column)), p.std, 2e-3 * p.std) << p.name;
      }
    }
    const Quality quality = assess(data, settings, result);
    EXPECT_TRUE(quality.cut_short.empty()) << quality.cut_short;
    EXPECT_FALSE(quality.split_half.cameras.empty()) << quality.split_half.why_not;
  }
}

// What is left out stays out, whatever is estimated in turn with the fit.
TEST(CornerNoise, CornersThatAreLeftOutStayOut) {
  Scene scene(imagesOf(2, 16), 9);
  const Dataset good = noisy(
      scene.data, [](auto, auto) { return 0.25; }, scene.random);
  Dataset bad = good;
  bad.cameras[0].views[4].corners[3].pixel.x() += 100;
  bad.cameras[0].views[9].corners[20].pixel.y() += 13;
  for (const auto& [robust, left_out] : {std::pair(Robust::reject, 2u), std::pair(Robust::huber, 1u)}) {
    for (const bool is_rolling : {false, true}) {
      Settings settings = with(robust, SigmaBy::slant);
      settings.rolling_shutter = is_rolling;
      const Result result = calibrate(bad, settings), expected = calibrate(good, settings);
      ASSERT_TRUE(result.success()) << result.message;
      EXPECT_EQ(result.rejected.size(), left_out);
      EXPECT_EQ(result.cameras[0].corners + left_out, bad.cameras[0].cornerCount());
      EXPECT_LT(result.cameras[0].rms_px, 0.8);
      for (std::size_t i = 0; i < 9; ++i) {
        const Parameter &p = result.cameras[0].parameters[i], &q = expected.cameras[0].parameters[i];
        EXPECT_NEAR(p.value, q.value, 0.5 * q.std) << p.name;
      }
      EXPECT_TRUE(assess(bad, settings, result).cut_short.empty());
    }
  }
  const Comparison comparison = compareModels(bad, Settings(), {Model("radial1"), Model("opencv5")});
  EXPECT_EQ(comparison.chosenTrial().model, Model("opencv5"));
}

TEST(CornerNoise, TooFewViewsHaveConstantNoise) {
  Scene scene(imagesOf(1, 3), 2);
  const Dataset data = noisy(
      scene.data, [](auto, auto) { return 0.25; }, scene.random);
  const Result result = calibrate(data, with(Robust::reject, SigmaBy::speed));
  ASSERT_TRUE(result.success()) << result.message;
  EXPECT_EQ(result.cameras[0].noise.growth, 0);
  EXPECT_EQ(result.cameras[0].noise.at(17), 1);
}

TEST(CornerNoise, DataWithoutNoiseAreFitted) {
  const Scene scene(imagesOf(1, 6), 2);
  for (const Robust robust : {Robust::huber, Robust::cauchy}) {
    for (const SigmaBy by : {SigmaBy::constant, SigmaBy::speed, SigmaBy::slant, SigmaBy::distance}) {
      const Result result = calibrate(scene.data, with(robust, by));
      EXPECT_TRUE(result.success()) << result.message;
      EXPECT_NEAR(result.cameras[0].parameters[0].value, scene.truth.cameras[0][0], 1e-6);
    }
  }
}

TEST(CornerNoise, ImpossibleSigmasAreNamed) {
  Scene scene(imagesOf(1, 4), 2);
  for (const auto& [sigma, text] :
       {std::pair(0.0, "0"), std::pair(-1.0, "-1"), std::pair(2e3, "2000"), std::pair(std::nan(""), "nan")}) {
    Dataset data = scene.data;
    data.cameras[0].views[1].corners[2].sigma = sigma;
    const Corner& corner = data.cameras[0].views[1].corners[2];
    EXPECT_EQ(slom::testing::messageOf([&] { calibrate(data, Settings()); }),
              "[slom.calibration.bad-corner] the sigma of corner " + std::to_string(corner.number) +
                  " of image " + std::to_string(data.cameras[0].views[1].image) + " of camera " +
                  data.cameras[0].name + " is " + text +
                  " times Settings::sigma_px; give a number from 0.001 to 1000");
  }
}

}  // namespace
}  // namespace slom::calibration
