/// VarID<T>: the user's handle to a variable of type T.
#pragma once

#include <memory>

#include "slom/model/variable_store.hpp"

namespace slom {

class Problem;

/// Reads the current value by `*id` and `id->member`. A cheap value type: copy it, store it, compare it. It stays
/// valid whatever else is inserted or removed. After removeRV it is stale, and reading it throws
/// [slom.stale-handle]; after the estimator is gone the last value can still be read.
template <class T>
class VarID {
 public:
  using Value = T;

  /// Refers to nothing; reading it throws.
  VarID() = default;

  const T& operator*() const { return current().value(ref_.slot); }
  const T* operator->() const { return &current().value(ref_.slot); }

  /// Whether the variable exists.
  bool isValid() const { return store_ && store_->isCurrent(ref_); }

  friend bool operator==(const VarID& a, const VarID& b) {
    return a.store_ == b.store_ && a.ref_.slot == b.ref_.slot && a.ref_.generation == b.ref_.generation;
  }

 private:
  friend class Problem;
  template <class>
  friend class VarArg;

  VarID(std::shared_ptr<VariableStore<T>> store, SlotRef ref) : store_(std::move(store)), ref_(ref) {}

  const VariableStore<T>& current() const {
    if (!isValid()) detail::raiseStaleHandle(typeName<T>(), store_ != nullptr);
    return *store_;
  }

  std::shared_ptr<VariableStore<T>> store_;
  SlotRef ref_;
};

/// A variable as a measurement sees it: `*pose`, `pose->pos`. Made from a VarID. Not owning; while a measurement
/// is in an estimator its variables cannot be removed.
template <class T>
class VarArg {
 public:
  using Value = T;

  VarArg(const VarID<T>& id)  // NOLINT(google-explicit-constructor): measurements are built from VarIDs
      : value_(&*id), store_(id.store_.get()), ref_(id.ref_) {}

  const T& operator*() const { return *value_; }
  const T* operator->() const { return value_; }

  /// Used by the library: where the value comes from, and what the measurement is evaluated at.
  const VariableStoreBase* store() const { return store_; }
  SlotRef slotRef() const { return ref_; }
  const T* pointer() const { return value_; }
#if defined(__GNUC__) && !defined(__clang__) && __GNUC__ >= 12
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdangling-pointer"  // detail::Redirected puts the old pointer back
#endif
  void setPointer(const T* value) { value_ = value; }
#if defined(__GNUC__) && !defined(__clang__) && __GNUC__ >= 12
#pragma GCC diagnostic pop
#endif

 private:
  const T* value_;
  const VariableStoreBase* store_;
  SlotRef ref_;
};

}  // namespace slom
