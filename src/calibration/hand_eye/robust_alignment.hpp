// Rotations between two sets of vectors, and averages of rotations, with gross errors among them.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "slom/calibration/types.hpp"

namespace slom::calibration {

/// Two vectors, first = R second.
struct VectorPair {
  Eigen::Vector3d first, second;
};

/// A rotation R from pairs of vectors.
struct Alignment {
  SO3 rotation;
  double misfit = 0;              ///< median of |first - R second|
  Eigen::Vector3d axis{0, 0, 1};  ///< principal direction of the first vectors
  bool is_turn_free = false;      ///< all vectors are parallel: R may turn about `axis`
};

/// Returns the rotation with the least sum of distances, by iterated weights. Source: Kabsch, 1976; Weiszfeld, 1937.
Alignment aligned(const std::vector<VectorPair>& pairs);

/// Returns the rotation with the least sum of angles to all.
SO3 averaged(const std::vector<SO3>& rotations);

}  // namespace slom::calibration
