/// VarID<T>: the user's handle to a variable of type T.
#pragma once

#include <concepts>
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
  /// Creates a handle that refers to nothing.
  VariableHandle();
  /// Creates a handle of a variable. Used by the library.
  VariableHandle(std::shared_ptr<VariableStoreBase> store, SlotRef ref);
  VariableHandle(const VariableHandle&);
  VariableHandle(VariableHandle&&) noexcept;
  VariableHandle& operator=(const VariableHandle&);
  VariableHandle& operator=(VariableHandle&&) noexcept;
  ~VariableHandle();

  /// Returns whether the variable exists.
  bool isValid() const { return store_ && store_->isCurrent(ref_); }

 protected:
  friend class Marginals;
  friend class Problem;
  friend class RuntimeType;
  friend class VariableArgument;

  bool equals(const VariableHandle& other) const {
    return store_ == other.store_ && ref_.slot == other.ref_.slot && ref_.generation == other.ref_.generation;
  }

  std::shared_ptr<VariableStoreBase> store_;
  SlotRef ref_;
};

/// True for the handles of variables: VarID<T> and AnyVarID.
template <class V>
concept AnyVariableHandle = std::derived_from<V, VariableHandle>;

/// A handle that reads the current value by `*id` and `id->member`. It is a cheap value type to copy, store and
/// compare. It stays valid if other variables are inserted or removed. After removeRV it is stale, and reading it
/// throws [slom.stale-handle]. After the end of the estimator, the last value can still be read.
template <class T>
class VarID : public VariableHandle {
 public:
  using Value = T;

  /// Creates a handle that refers to nothing; reading it throws.
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
  /// Returns the store of the variable. Used by the library.
  const VariableStoreBase* store() const { return store_; }
  /// Returns the place of the variable in its store.
  SlotRef slotRef() const { return ref_; }
  /// Returns the value at which the measurement is evaluated, of the variable's type.
  const void* pointer() const { return value_; }
#if defined(__GNUC__) && !defined(__clang__) && __GNUC__ >= 12
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdangling-pointer"  // numeric derivatives put the old pointer back
#endif
  /// Sets another value for evaluation, which must outlive the evaluation.
  void setPointer(const void* value) { value_ = value; }
  /// Replaces the variable by another of the same type, with its current value.
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

/// A variable in a measurement: `*pose`, `pose->pos`. Made from a VarID. It does not own the variable, but while a
/// measurement is in an estimator, its variables cannot be removed.
template <class T>
class VarArg : public VariableArgument {
 public:
  using Value = T;

  /// Converts a handle, implicitly. Throws [slom.stale-handle].
  VarArg(const VarID<T>& id)  // NOLINT(google-explicit-constructor): measurements are built from VarIDs
      : VariableArgument(id, &*id) {}

  const T& operator*() const { return *static_cast<const T*>(value_); }
  const T* operator->() const { return static_cast<const T*>(value_); }
};

}  // namespace slom
