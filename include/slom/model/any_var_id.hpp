/// AnyVarID: a handle to a variable of any type, for lists of variables of different types.
///     std::vector<slom::AnyVarID> all{pose, landmark, scale};   // VarIDs
#pragma once

#include <typeinfo>

#include "slom/model/var_id.hpp"

namespace slom {

namespace detail {
[[noreturn]] void raiseWrongType(const VariableStoreBase& store, std::string (*asked)());

template <class T>
bool holdsType(const VariableStoreBase* store) {
  return store != nullptr && typeid(*store) == typeid(VariableStore<T>);
}
template <class T>
void requireType(const VariableStoreBase& store) {
  if (!holdsType<T>(&store)) raiseWrongType(store, &slom::typeName<T>);
}
}  // namespace detail

/// A handle made from any VarID; a cheap value type.
class AnyVarID : public VariableHandle {
 public:
  /// Converts the handle to a variable of any type, implicitly.
  template <class T>
  AnyVarID(const VarID<T>& id)  // NOLINT(google-explicit-constructor): a VarID is one of any type
      : VariableHandle(id) {}
  /// Creates a handle whose type only its store has. Used by the library.
  explicit AnyVarID(const VariableHandle& handle) : VariableHandle(handle) {}

  /// Returns whether the handle is a VarID<T>.
  template <class T>
  bool is() const {
    return detail::holdsType<T>(store_.get());
  }
  /// Returns the current value. Throws [slom.wrong-type] if it is not a T, and [slom.stale-handle] as a VarID does.
  template <class T>
  const T& as() const {
    const void* const value = current();
    detail::requireType<T>(*store_);
    return *static_cast<const T*>(value);
  }
  /// Returns the VarID. Throws as `as` does.
  template <class T>
  VarID<T> id() const {
    as<T>();
    return VarID<T>(*this);
  }
  /// Returns the degrees of freedom of the current value.
  int dof() const { return store_->dofOf(current()); }

  /// Returns the current value. Throws [slom.stale-handle]. Used by the library.
  const void* current() const;
  /// Returns the store of the value. Used by the library.
  const VariableStoreBase* store() const { return store_.get(); }

  friend bool operator==(const AnyVarID& a, const AnyVarID& b) { return a.equals(b); }
};

/// A variable of any type in a measurement function: `x[0].as<Pose>().pos`.
class VariableView : public VariableArgument {
 public:
  /// Refers to the variable's current value. Only the library creates views.
  explicit VariableView(const AnyVarID& id) : VariableArgument(id, id.current()) {}

  /// Returns whether the variable is a T.
  template <class T>
  bool is() const {
    return detail::holdsType<T>(store());
  }
  /// Returns the value at which the measurement is evaluated. Throws [slom.wrong-type] if it is not a T.
  template <class T>
  const T& as() const {
    detail::requireType<T>(*store());
    return *static_cast<const T*>(value_);
  }
  /// Returns the degrees of freedom of the value.
  int dof() const { return store()->dofOf(value_); }
};

}  // namespace slom
