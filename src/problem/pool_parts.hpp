/// Parts of a pool of measurements that only sources use.
#pragma once

#include <cstdint>
#include <memory>
#include <set>
#include <vector>

#include "slom/problem/measurement_pool.hpp"

namespace slom {

/// The different losses of the pool. Their addresses do not change.
struct MeasurementPool::Losses {
  std::set<Loss> all;
};

/// The pools that this pool is a copy of, the original first, and their contents at the time of copying. Up to then,
/// slots are the same in all of them.
struct MeasurementPool::Origins {
  struct Origin {
    std::weak_ptr<const PoolPresence> presence;
    std::vector<std::uint32_t> generations;  // of the slots; VariableStoreBase::kFree for free slots
  };
  std::vector<Origin> all;
};

}  // namespace slom
