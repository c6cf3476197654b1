// The rotation nearest to a matrix, against rotations that are known.
#include "calibration/nearest_rotation.hpp"

#include <gtest/gtest.h>

#include "slom/calibration/types.hpp"

namespace slom::calibration {
namespace {

const Eigen::Matrix3d turn = SO3::exp(vec3(0.4, -1.1, 0.7)).toRotationMatrix();

TEST(NearestRotation, OfAPolarDecompositionIsItsRotation) {
  Eigen::Matrix3d stretch;
  stretch << 3, 0.2, 0.1, 0.2, 2, -0.3, 0.1, -0.3, 1;  // positive definite
  EXPECT_LT((nearestRotation(Eigen::Matrix3d(turn * stretch)) - turn).norm(), 1e-12);
  EXPECT_LT((nearestRotation(Eigen::Matrix3d(-turn * stretch), true) + turn).norm(), 1e-12);
}

/// The direction of the least singular value is the one that is turned over.
TEST(NearestRotation, HasTheDeterminantAskedFor) {
  const Eigen::Matrix3d mirror = Eigen::Vector3d(3, 2, -1).asDiagonal();
  EXPECT_LT((nearestRotation(Eigen::Matrix3d(turn * mirror)) - turn).norm(), 1e-12);
  const Eigen::Matrix3d other = turn * Eigen::Vector3d(1, 1, -1).asDiagonal();
  EXPECT_LT((nearestRotation(Eigen::Matrix3d(turn * mirror), true) - other).norm(), 1e-12);
}

}  // namespace
}  // namespace slom::calibration
