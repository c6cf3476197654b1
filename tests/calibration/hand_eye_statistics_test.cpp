// Errors of simulated hand-eye calibrations have the size that their standard deviations state.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "calibration/hand_eye_streams.hpp"

namespace slom::testing {
namespace {

using calibration::HandEyeResult;
using calibration::HandEyeSettings;

using Errors = Eigen::Matrix<double, 6, 1>;

Errors errorOf(const SE3& estimate, const SE3& truth) {
  Errors error;
  estimate.boxminus(mtk::vectview<double, 6>(error.data()), truth);
  return error;
}

/// Sums of squares of errors over standard deviations.
struct MeanSquare {
  double sum = 0, sum_clustered = 0;
  int count = 0;

  void add(const Errors& error, const calibration::PoseEstimate& estimate) {
    sum += error.cwiseQuotient(Errors(estimate.std)).squaredNorm();
    sum_clustered += error.cwiseQuotient(Errors(estimate.std_clustered)).squaredNorm();
    count += 6;
  }
  void add(double truth, const calibration::NumberEstimate& estimate) {
    sum += std::pow((estimate.value - truth) / estimate.std, 2);
    sum_clustered += std::pow((estimate.value - truth) / estimate.std_clustered, 2);
    ++count;
  }
};

TEST(HandEyeStatistics, ErrorsOverStdAreUnitNormal) {
  constexpr unsigned seeds = 50;
  MeanSquare poses, offsets, scales;
  std::size_t outliers = 0, missed = 0, wrong = 0;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    SimulatedHand truth;
    truth.seed = 7919 * seed + 1;
    truth.outliers = 0.1;
    truth.scale = 0.37;
    const SimulatedStreams streams = simulated(truth);
    HandEyeSettings settings;
    settings.estimate_scale = true;
    const HandEyeResult result = handEye(streams.hand, streams.camera, settings);
    ASSERT_TRUE(result.success()) << seed << " " << result.message;
    poses.add(errorOf(result.hand_T_camera.pose, truth.hand_T_camera), result.hand_T_camera);
    poses.add(errorOf(result.base_T_target->pose, truth.base_T_target), *result.base_T_target);
    offsets.add(truth.offset, result.time_offset_s);
    scales.add(truth.scale, result.scale);
    // The camera sees the end of the motion, which the hand's stream lacks.
    outliers += streams.outliers.size();
    std::vector<std::size_t> found;
    for (const auto& outlier : result.outliers)
      found.push_back(std::size_t(std::stoi(outlier.place.substr(11)) - 2));
    std::sort(found.begin(), found.end());
    for (const std::size_t row : streams.outliers)
      missed += !std::binary_search(found.begin(), found.end(), row);
    for (const std::size_t row : found)
      wrong += !std::binary_search(streams.outliers.begin(), streams.outliers.end(), row);
  }
  // Standard deviation of a mean of 50 squares: 0.2; poses have at least 3 times as many independent ones.
  EXPECT_NEAR(poses.sum / poses.count, 1, 0.25);
  EXPECT_NEAR(offsets.sum / seeds, 1, 0.5);
  EXPECT_NEAR(scales.sum / seeds, 1, 0.5);
  EXPECT_NEAR(poses.sum_clustered / poses.count, 1, 0.4);
  EXPECT_LT(double(missed), 0.02 * double(outliers));
  EXPECT_LT(double(wrong), 0.02 * double(outliers));
}

}  // namespace
}  // namespace slom::testing
