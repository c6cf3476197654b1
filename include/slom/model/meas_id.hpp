/// MeasID<M>: the user's handle to a measurement. AnyMeasID: a handle to a measurement of any type.
///     std::vector<slom::AnyMeasID> all;
///     all.push_back(est.insertMeasurement(...));   // whatever its type
#pragma once

#include <memory>
#include <utility>

#include "slom/model/variable_store.hpp"

namespace slom {

class MeasurementPool;
class Problem;

/// Presence of the pool that handles refer to; handles may outlive the pool.
struct PoolPresence {
  const MeasurementPool* pool;  ///< null: the pool no longer exists
};

/// The part of a MeasID that does not depend on the type.
class MeasurementHandle {
 public:
  /// Creates a handle that refers to nothing.
  MeasurementHandle();
  /// Creates a handle of a measurement. Used by the library.
  MeasurementHandle(std::shared_ptr<const PoolPresence> presence, SlotRef ref);
  MeasurementHandle(const MeasurementHandle&);
  MeasurementHandle(MeasurementHandle&&) noexcept;
  MeasurementHandle& operator=(const MeasurementHandle&);
  MeasurementHandle& operator=(MeasurementHandle&&) noexcept;
  ~MeasurementHandle();

  /// Returns whether the measurement exists: false after removeMeasurement and after the end of the estimator.
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

/// A cheap value type. It stays valid if other measurements are inserted or removed. After removeMeasurement it is
/// stale, and using it throws [slom.stale-handle].
template <class M>
class MeasID : public MeasurementHandle {
 public:
  /// Creates a handle that refers to nothing; using it throws.
  MeasID() = default;

  friend bool operator==(const MeasID& a, const MeasID& b) { return a.equals(b); }

 private:
  friend class Problem;
  explicit MeasID(MeasurementHandle handle) : MeasurementHandle(std::move(handle)) {}
};

/// A handle made from any MeasID. The estimator accepts it in place of a MeasID.
class AnyMeasID : public MeasurementHandle {
 public:
  /// Creates a handle that refers to nothing; using it throws.
  AnyMeasID() = default;
  /// Converts the handle to a measurement of any type, implicitly.
  template <class M>
  AnyMeasID(const MeasID<M>& id)  // NOLINT(google-explicit-constructor): a MeasID is one of any type
      : MeasurementHandle(id) {}
  /// Creates a handle for a measurement whose type only its pool has. Used by the library.
  explicit AnyMeasID(MeasurementHandle handle) : MeasurementHandle(std::move(handle)) {}

  friend bool operator==(const AnyMeasID& a, const AnyMeasID& b) { return a.equals(b); }
};

}  // namespace slom
