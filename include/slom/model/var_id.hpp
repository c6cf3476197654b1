/// VarID<T>: the user's handle to a variable of type T.
#pragma once

#include <memory>

#include "slom/model/variable_store.hpp"

namespace slom {

class AnyVarID;
class Archive;
class Marginals;
class Problem;
class StoredProblem;

/// The part of a VarID that does not depend on the type.
class VariableHandle {
 public:
  /// Refers to nothing.
  VariableHandle();
  /// Of a variable; made by the library.
  VariableHandle(std::shared_ptr<VariableStoreBase> store, SlotRef ref);
  VariableHandle(const VariableHandle&);
  VariableHandle(VariableHandle&&) noexcept;
  VariableHandle& operator=(const VariableHandle&);
  VariableHandle& operator=(VariableHandle&&) noexcept;
  ~VariableHandle();

  /// Whether the variable exists.
  bool isValid() const { return store_ && store_->isCurrent(ref_); }

 protected:
  friend class Marginals;
  friend class Problem;
  friend class VariableArgument;

  bool equals(const VariableHandle& other) const {
    return store_ == other.store_ && ref_.slot == other.ref_.slot && ref_.generation == other.ref_.generation;
  }

  std::shared_ptr<VariableStoreBase> store_;
  SlotRef ref_;
};

/// Reads the current value by `*id` and `id->member`. A cheap value type: copy it, store it, compare it. It stays
/// valid whatever else is inserted or removed. After removeRV it is stale, and reading it throws
/// [slom.stale-handle]; after the estimator is gone the last value can still be read.
template <class T>
class VarID : public VariableHandle {
 public:
  using Value = T;

  /// Refers to nothing; reading it throws.
  VarID() = default;

  const T& operator*() const { return current(); }
  const T* operator->() const { return &current(); }

  friend bool operator==(const VarID& a, const VarID& b) { return a.equals(b); }

 private:
  friend class AnyVarID;
  friend class Archive;
  friend class Problem;
  friend class StoredProblem;

  explicit VarID(VariableHandle handle) : VariableHandle(std::move(handle)) {}

  const T& current() const {
    if (!isValid()) detail::raiseStaleHandle(&typeName<T>, store_ != nullptr);
    return store_->template value<T>(ref_.slot);
  }
};

/// The part of a VarArg that does not depend on the type.
class VariableArgument {
 public:
  /// Used by the library: where the value comes from, and what the measurement is evaluated at.
  const VariableStoreBase* store() const { return store_; }
  /// The place of the variable in its store.
  SlotRef slotRef() const { return ref_; }
  /// The value that the measurement is evaluated at, of the variable's type.
  const void* pointer() const { return value_; }
#if defined(__GNUC__) && !defined(__clang__) && __GNUC__ >= 12
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdangling-pointer"  // numeric derivatives put the old pointer back
#endif
  /// Has the measurement evaluated at another value, which must outlive the evaluation.
  void setPointer(const void* value) { value_ = value; }
  /// Makes it another variable of the same type, with its current value.
  void rebind(const VariableHandle& id) {
    store_ = id.store_.get();
    ref_ = id.ref_;
    value_ = id.store_->valueAt(id.ref_.slot);
  }
#if defined(__GNUC__) && !defined(__clang__) && __GNUC__ >= 12
#pragma GCC diagnostic pop
#endif

 protected:
  VariableArgument(const VariableHandle& id, const void* value)
      : value_(value), store_(id.store_.get()), ref_(id.ref_) {}

  const void* value_;

 private:
  const VariableStoreBase* store_;
  SlotRef ref_;
};

/// A variable as a measurement sees it: `*pose`, `pose->pos`. Made from a VarID. Not owning; while a measurement
/// is in an estimator its variables cannot be removed.
template <class T>
class VarArg : public VariableArgument {
 public:
  using Value = T;

  /// From the handle, implicitly. Throws [slom.stale-handle].
  VarArg(const VarID<T>& id)  // NOLINT(google-explicit-constructor): measurements are built from VarIDs
      : VariableArgument(id, &*id) {}

  const T& operator*() const { return *static_cast<const T*>(value_); }
  const T* operator->() const { return static_cast<const T*>(value_); }
};

}  // namespace slom
