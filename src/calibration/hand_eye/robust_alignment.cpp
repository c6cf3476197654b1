#include "calibration/hand_eye/robust_alignment.hpp"

#include <algorithm>
#include <cmath>

#include "calibration/median.hpp"
#include "calibration/nearest_rotation.hpp"

namespace slom::calibration {
namespace {

constexpr int most_rounds = 30;

/// Weights 1 / distance, bounded by a fraction of the median distance.
std::vector<double> weightsFor(const std::vector<double>& distances) {
  const double least = std::max(0.3 * medianOf(distances), 1e-12);
  std::vector<double> weights;
  for (const double distance : distances) weights.push_back(least / std::max(distance, least));
  return weights;
}

}  // namespace

Alignment aligned(const std::vector<VectorPair>& pairs) {
  constexpr double parallel = 0.02;  // ratio of singular values
  std::vector<double> distances;     // before R is known: lengths do not depend on it
  for (const VectorPair& pair : pairs) distances.push_back(std::abs(pair.first.norm() - pair.second.norm()));
  Alignment result;
  for (int round = 0; round < most_rounds; ++round) {
    const std::vector<double> weights = weightsFor(distances);
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < pairs.size(); ++i)
      sum += weights[i] * pairs[i].first * pairs[i].second.transpose();
    const Svd3 svd = svdOf(sum);
    const SO3 before = result.rotation;
    result.rotation = SO3(nearestRotation(svd));
    result.axis = svd.matrixU().col(0);
    result.is_turn_free = svd.singularValues()[1] < parallel * svd.singularValues()[0];
    for (std::size_t i = 0; i < pairs.size(); ++i)
      distances[i] = (pairs[i].first - Eigen::Vector3d(result.rotation * pairs[i].second)).norm();
    if (round > 0 && SO3::log(before.inverse() * result.rotation).norm() < 1e-7) break;
  }
  result.misfit = medianOf(distances);
  return result;
}

SO3 averaged(const std::vector<SO3>& rotations) {
  SO3 mean = rotations.front();
  std::vector<double> distances(rotations.size(), 1);
  for (int round = 0; round < most_rounds; ++round) {
    const std::vector<double> weights = weightsFor(distances);
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < rotations.size(); ++i) sum += weights[i] * rotations[i].toRotationMatrix();
    const SO3 before = mean;
    mean = SO3(nearestRotation(sum));
    for (std::size_t i = 0; i < rotations.size(); ++i)
      distances[i] = SO3::log(mean.inverse() * rotations[i]).norm();
    if (round > 0 && SO3::log(before.inverse() * mean).norm() < 1e-7) break;
  }
  return mean;
}

}  // namespace slom::calibration
