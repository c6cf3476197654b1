/// Stated noise: whether a user has stated the uncertainty of measurements. Without a statement, covariances are 1.
#pragma once

#include <algorithm>

#include "slom/problem/problem.hpp"

namespace slom {

/// Returns whether the noise of a pool is stated. The first measurement stands for all.
inline bool statesNoise(const MeasurementPool& pool) {
  return pool.size() > 0 && (pool.type().states_noise || pool.whitening(0).first != WhiteningKind::unit);
}
/// Returns whether the noise of a group is stated. The first measurement stands for all.
inline bool groupStatesNoise(const Problem& problem, std::size_t group) {
  const auto first = std::find_if(problem.pools().begin(), problem.pools().end(), [&](const auto& pool) {
    return pool->group() == static_cast<int>(group) && pool->size() > 0;
  });
  return first != problem.pools().end() && statesNoise(**first);
}
inline bool statesAllNoise(const Problem& problem) {
  return std::all_of(problem.pools().begin(), problem.pools().end(),
                     [](const auto& pool) { return pool->size() == 0 || statesNoise(*pool); });
}

}  // namespace slom
