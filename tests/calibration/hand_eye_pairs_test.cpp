// Single poses, row by row, beside a closed form; and the derivatives and the rank of the fit.
#include <random>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <slom/slom.hpp>

#include "calibration/hand_eye/fit.hpp"
#include "calibration/hand_eye_streams.hpp"

namespace slom::testing {
namespace {

using calibration::HandEyeResult;
using calibration::HandEyeSettings;

/// A X = X B in closed form: rotation by M = sum of (log B) (log A)^T, R = (M^T M)^(-1/2) M^T; then the translation by
/// linear least squares. This is what OpenCV's CALIB_HAND_EYE_PARK computes.
///   source   Park and Martin, "Robot sensor calibration: solving AX = XB on the Euclidean group", 1994
SE3 parkMartin(const std::vector<SE3>& A, const std::vector<SE3>& B) {
  Eigen::Matrix3d M = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < A.size(); ++i)
    M += Eigen::Vector3d(SO3::log(B[i].orient)) * SO3::log(A[i].orient).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(M.transpose() * M);
  const Eigen::Matrix3d R = eigen.operatorInverseSqrt() * M.transpose();
  Eigen::MatrixXd C(3 * A.size(), 3);
  Eigen::VectorXd d(3 * A.size());
  for (std::size_t i = 0; i < A.size(); ++i) {
    const auto row = 3 * Eigen::Index(i);
    C.middleRows<3>(row) = Eigen::Matrix3d::Identity() - Eigen::Matrix3d(A[i].orient.toRotationMatrix());
    d.segment<3>(row) = A[i].pos - R * B[i].pos;
  }
  const Eigen::Vector3d t = C.colPivHouseholderQr().solve(d);
  return {SO3(R), vec3(t)};
}

/// Poses of a robot that stops at random places, as for OpenCV's calibrateHandEye.
SimulatedStreams stops(int count, double noise_m, double noise_rad, unsigned seed) {
  const SimulatedHand truth;
  std::mt19937 random(seed);
  SimulatedStreams streams;
  for (int i = 0; i < count; ++i) {
    const SE3 hand = disturbed(SE3(), 0.4, 0.5, random);
    const SE3 camera = truth.base_T_target.inverse() * hand * truth.hand_T_camera;
    streams.hand.poses.push_back({double(i), hand, 0});
    streams.camera.poses.push_back({double(i), disturbed(camera, noise_m, noise_rad, random), 0});
  }
  return streams;
}

HandEyeSettings pairs() {
  HandEyeSettings settings;
  settings.pairs = true;
  return settings;
}

SE3 closedForm(const SimulatedStreams& streams) {
  std::vector<SE3> A, B;
  for (std::size_t i = 0; i < streams.hand.poses.size(); ++i) {
    for (std::size_t k = i + 1; k < streams.hand.poses.size(); ++k) {
      A.push_back(streams.hand.poses[i].pose.inverse() * streams.hand.poses[k].pose);
      B.push_back(streams.camera.poses[i].pose.inverse() * streams.camera.poses[k].pose);
    }
  }
  return parkMartin(A, B);
}

TEST(HandEyePairs, ExactPosesGiveTheClosedForm) {
  for (const int count : {3, 5, 20}) {
    const SimulatedStreams streams = stops(count, 0, 0, 3);
    const HandEyeResult result = handEye(streams.hand, streams.camera, pairs());
    ASSERT_TRUE(result.success()) << count << " " << result.message;
    const SE3 oracle = closedForm(streams);
    EXPECT_LT((result.hand_T_camera.pose.pos - oracle.pos).norm(), 1e-7) << count;
    EXPECT_LT(SO3::log(result.hand_T_camera.pose.orient.inverse() * oracle.orient).norm(), 1e-7) << count;
    EXPECT_EQ(result.rows, count);
    EXPECT_EQ(result.time_offset_s.value, 0);
  }
}

TEST(HandEyePairs, NoisyPosesAreNearTheClosedFormAndNearerToTheTruth) {
  const SimulatedHand truth;
  double own = 0, closed = 0, mean_square = 0;
  constexpr int seeds = 100;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    const SimulatedStreams streams = stops(25, 0.002, 0.003, 7919 * seed);
    const HandEyeResult result = handEye(streams.hand, streams.camera, pairs());
    ASSERT_TRUE(result.success()) << seed << " " << result.message;
    const SE3 oracle = closedForm(streams);
    EXPECT_LT((result.hand_T_camera.pose.pos - oracle.pos).norm(),
              10 * result.hand_T_camera.std.head<3>().maxCoeff());
    EXPECT_LT(SO3::log(result.hand_T_camera.pose.orient.inverse() * oracle.orient).norm(),
              10 * result.hand_T_camera.std.tail<3>().maxCoeff());
    own += (result.hand_T_camera.pose.pos - truth.hand_T_camera.pos).squaredNorm();
    closed += (oracle.pos - truth.hand_T_camera.pos).squaredNorm();
    Eigen::Matrix<double, 6, 1> error;
    result.hand_T_camera.pose.boxminus(mtk::vectview<double, 6>(error.data()), truth.hand_T_camera);
    mean_square +=
        error.cwiseQuotient(Eigen::Matrix<double, 6, 1>(result.hand_T_camera.std)).squaredNorm() / 6 / seeds;
  }
  EXPECT_LT(own, closed);
  EXPECT_NEAR(mean_square, 1, 0.25);
}

TEST(HandEyePairs, WrongPairsAreLeftOut) {
  SimulatedStreams streams = stops(30, 0.001, 0.001, 5);
  std::swap(streams.camera.poses[3].pose, streams.camera.poses[17].pose);
  const HandEyeResult result = handEye(streams.hand, streams.camera, pairs());
  ASSERT_TRUE(result.success());
  ASSERT_EQ(result.outliers.size(), 2u);
  EXPECT_EQ(result.outliers[0].t_s + result.outliers[1].t_s, 20);
  EXPECT_LT((result.hand_T_camera.pose.pos - SimulatedHand().hand_T_camera.pos).norm(), 0.003);
}

/// The problem of a fit, at given values.
calibration::HandEyeProblem problemOf(const calibration::Streams& streams, const HandEyeSettings& settings,
                                      const SimulatedHand& truth) {
  calibration::HandEyeProblem problem(
      streams, settings,
      {truth.hand_T_camera, truth.base_T_target, streams.shiftOf(truth.offset) + 0.0123, 1.02}, {});
  const auto rows = streams.covered(streams.shiftOf(truth.offset));
  const calibration::Items items = settings.drifting ? motionsOver(streams, rows, 1) : [&] {
    calibration::Items all;
    for (const std::size_t row : rows) all.push_back({row, row});
    return all;
  }();
  problem.insert(items, Loss(), 1);
  return problem;
}

TEST(HandEyeFit, DerivativesAgreeWithDifferences) {
  for (const bool drifting : {false, true}) {
    for (const double hand_rate : {50, 10}) {  // the hand is interpolated, or the camera
      SimulatedHand truth;
      truth.hand_rate = hand_rate;
      truth.seconds = 5;
      const SimulatedStreams simulation = simulated(truth);
      const calibration::Streams streams(simulation.hand, simulation.camera);
      HandEyeSettings settings;
      settings.drifting = drifting;
      settings.estimate_scale = true;
      auto problem = problemOf(streams, settings, truth);
      const DerivativeCheck check = checkDerivatives(problem.estimator());
      EXPECT_TRUE(check.ok()) << check;
      for (const auto& group : problem.optimize().groups) EXPECT_EQ(group.derivatives, "exact");
    }
  }
}

TEST(HandEyeFit, TheDiagnosisNamesWhatOneAxisLeavesFree) {
  SimulatedHand truth;
  truth.motion = HandMotion::one_axis;
  truth.noise_m = truth.noise_rad = 0;
  const SimulatedStreams simulation = simulated(truth);
  const calibration::Streams streams(simulation.hand, simulation.camera);
  for (const bool drifting : {false, true}) {
    HandEyeSettings settings;
    settings.drifting = drifting;
    auto problem = problemOf(streams, settings, truth);
    const Diagnosis diagnosis = diagnose(problem.estimator());
    EXPECT_EQ(diagnosis.unknowns - diagnosis.rank, 1) << diagnosis;
    EXPECT_NE(diagnosis.text().find("hand_T_camera.pos.z"), std::string::npos) << diagnosis;
  }
}

}  // namespace
}  // namespace slom::testing
