/// MeasID<M>: the user's handle to a measurement; AnyMeasID: to one of any type.
///     std::vector<slom::AnyMeasID> all;
///     all.push_back(est.insertMeasurement(...));   // whatever its type
#pragma once

#include <memory>
#include <utility>

#include "slom/model/variable_store.hpp"

namespace slom {

class MeasurementPool;
class Problem;

/// Whether the pool that a handle refers to is there, which handles may outlive.
struct PoolPresence {
  const MeasurementPool* pool;  ///< null: it is gone
};

/// The part of a MeasID that does not depend on the type.
class MeasurementHandle {
 public:
  /// Refers to nothing.
  MeasurementHandle();
  /// Of a measurement; made by the library.
  MeasurementHandle(std::shared_ptr<const PoolPresence> presence, SlotRef ref);
  MeasurementHandle(const MeasurementHandle&);
  MeasurementHandle(MeasurementHandle&&) noexcept;
  MeasurementHandle& operator=(const MeasurementHandle&);
  MeasurementHandle& operator=(MeasurementHandle&&) noexcept;
  ~MeasurementHandle();

  /// Whether the measurement exists: not after removeMeasurement, nor once the estimator is gone.
  bool isValid() const;

 protected:
  friend class MeasurementPool;
  friend class Problem;

  bool equals(const MeasurementHandle& other) const {
    return presence_ == other.presence_ && ref_.slot == other.ref_.slot &&
           ref_.generation == other.ref_.generation;
  }

  std::shared_ptr<const PoolPresence> presence_;
  SlotRef ref_;
};

/// A cheap value type. It stays valid whatever else is inserted or removed; after removeMeasurement it is stale, and
/// using it throws [slom.stale-handle].
template <class M>
class MeasID : public MeasurementHandle {
 public:
  /// Refers to nothing; using it throws.
  MeasID() = default;

  friend bool operator==(const MeasID& a, const MeasID& b) { return a.equals(b); }

 private:
  friend class Problem;
  explicit MeasID(MeasurementHandle handle) : MeasurementHandle(std::move(handle)) {}
};

/// Made of any MeasID; the estimator takes it wherever it takes one.
class AnyMeasID : public MeasurementHandle {
 public:
  /// Refers to nothing; using it throws.
  AnyMeasID() = default;
  /// From the handle to a measurement of any type, implicitly.
  template <class M>
  AnyMeasID(const MeasID<M>& id)  // NOLINT(google-explicit-constructor): a MeasID is one of any type
      : MeasurementHandle(id) {}
  /// Used by the library, for measurements whose type only their pool knows.
  explicit AnyMeasID(MeasurementHandle handle) : MeasurementHandle(std::move(handle)) {}

  friend bool operator==(const AnyMeasID& a, const AnyMeasID& b) { return a.equals(b); }
};

}  // namespace slom
