// Ceres gives covariances in the tangent spaces of its manifolds. For the comparison, they are converted to those of
// SLoM.
#include <cmath>
#include <stdexcept>
#include <utility>

#include <Eigen/Geometry>
#include <ceres/ceres.h>
#include <ceres/normal_prior.h>

#include "fit/ceres_problem.hpp"
#include "fit/stopwatch.hpp"
#include "marginals/marginals.hpp"

namespace slom::bench {

namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using io::Camera;
using io::Pose2;
using io::Pose3;

/// Returns J such that a step d of Ceres is the step J d of SLoM.
MatrixXd stepsOf(const Pose2&) { return Matrix3d::Identity(); }

/// Returns J for poses in space. A step d of EigenQuaternionManifold turns by 2 d in the outer frame, a step of SLoM by
/// d in the inner frame.
MatrixXd stepsOf(const Pose3& pose) {
  MatrixXd J = MatrixXd::Identity(6, 6);
  J.bottomRightCorner<3, 3>() = 2 * Matrix3d(pose.orient.toRotationMatrix()).transpose();
  return J;
}

/// Returns J for cameras. For angle-axis p, exp(p + d) = exp(p) exp(J d) to first order with the right Jacobian of
/// SO(3),
///   I - (1 - cos|p|) / |p|^2 [p]x + (|p| - sin|p|) / |p|^3 [p]x^2.
/// Ceres' camera has the rotation before the translation.
MatrixXd stepsOf(const Camera& camera) {
  const Eigen::AngleAxisd turn(Matrix3d(camera.pose.orient.toRotationMatrix()));
  const double angle = turn.angle();
  const Eigen::Vector3d u = turn.axis();
  Matrix3d cross;
  cross << 0, -u.z(), u.y(), u.z(), 0, -u.x(), -u.y(), u.x(), 0;
  MatrixXd J = MatrixXd::Zero(9, 9);
  J.block<3, 3>(0, 3).setIdentity();
  J.block<3, 3>(3, 0).setIdentity();
  if (angle > 0) {
    J.block<3, 3>(3, 0) +=
        (std::cos(angle) - 1) / angle * cross + (1 - std::sin(angle) / angle) * cross * cross;
  }
  J.block<3, 3>(6, 6).setIdentity();
  return J;
}

ceres::Covariance::Options options() {
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::SPARSE_QR;
  options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  options.num_threads = 1;
  return options;
}

/// Computes marginals. `steps`: the J of each variable; empty for a fixed one.
Marginals marginalsOf(CeresProblem& problem, const std::vector<MatrixXd>& steps) {
  std::vector<std::pair<const double*, const double*>> pairs;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const auto& blocks = problem.blocks[i];
    for (std::size_t a = 0; a < blocks.size() && steps[i].size() > 0; ++a) {
      for (std::size_t b = a; b < blocks.size(); ++b) pairs.emplace_back(blocks[a], blocks[b]);
    }
  }
  ceres::Covariance covariance(options());
  Marginals result;
  bool ok = false;
  result.seconds = processorSecondsOf([&] { ok = covariance.Compute(pairs, &problem.problem); });
  if (!ok) throw std::runtime_error("finds J rank deficient");
  for (std::size_t i = 0; i < steps.size(); ++i) {
    MatrixXd own(steps[i].rows(), steps[i].cols());
    if (own.size() > 0) covariance.GetCovarianceMatrixInTangentSpace(problem.blocks[i], own.data());
    result.blocks.push_back(steps[i] * own * steps[i].transpose());
  }
  return result;
}

}  // namespace

template <class Pose>
Marginals marginalsByCeres(const io::PoseGraph<Pose>& graph) {
  std::vector<MatrixXd> steps;
  for (const auto& pose : graph.poses) steps.push_back(pose.fixed ? MatrixXd() : stepsOf(pose.value));
  return marginalsOf(*ceresProblemOf(graph, 0), steps);
}
template Marginals marginalsByCeres(const io::PoseGraph<Pose2>&);
template Marginals marginalsByCeres(const io::PoseGraph<Pose3>&);

Marginals marginalsByCeres(const io::Scene& scene) {
  const auto problem = ceresProblemOf(scene, 0);
  for (double* const point : problem->eliminated_first) {
    const ceres::Matrix weight = ceres::Matrix::Identity(3, 3) / kPointSigma;
    problem->problem.AddResidualBlock(new ceres::NormalPrior(weight, Eigen::Vector3d(point)), nullptr, point);
  }
  problem->problem.SetParameterBlockConstant(const_cast<double*>(problem->blocks[0][0]));
  problem->problem.SetParameterBlockConstant(problem->eliminated_first[0]);
  std::vector<MatrixXd> steps;
  for (const auto& camera : scene.cameras) steps.push_back(stepsOf(camera));
  steps[0] = MatrixXd();
  return marginalsOf(*problem, steps);
}

}  // namespace slom::bench
