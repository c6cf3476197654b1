/// MeasID<M>: the user's handle to a measurement.
#pragma once

#include "slom/model/variable_store.hpp"

namespace slom {

class MeasurementPool;

/// A cheap value type. It stays valid whatever else is inserted or removed; after removeMeasurement it is stale, and
/// using it throws [slom.stale-handle].
template <class M>
class MeasID {
 public:
  MeasID() = default;

  friend bool operator==(const MeasID& a, const MeasID& b) {
    return a.pool_ == b.pool_ && a.ref_.slot == b.ref_.slot && a.ref_.generation == b.ref_.generation;
  }

 private:
  friend class Problem;
  MeasID(const MeasurementPool* pool, SlotRef ref) : pool_(pool), ref_(ref) {}

  const MeasurementPool* pool_ = nullptr;
  SlotRef ref_;
};

}  // namespace slom
