/// What only sources know of a pool of measurements.
#pragma once

#include <cstdint>
#include <memory>
#include <set>
#include <vector>

#include "slom/problem/measurement_pool.hpp"

namespace slom {

/// The different losses of the pool; their places in memory stay.
struct MeasurementPool::Losses {
  std::set<Loss> all;
};

/// Pools that this one is a copy of, the original one first, and what was in them when they were copied. Slots are the same in all of
/// them until then.
struct MeasurementPool::Origins {
  struct Origin {
    std::weak_ptr<const PoolPresence> presence;
    std::vector<std::uint32_t> generations;  // of the slots; VariableStoreBase::kFree of free ones
  };
  std::vector<Origin> all;
};

}  // namespace slom
