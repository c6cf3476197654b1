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

/// Made of any VarID; a cheap value type like it.
class AnyVarID : public VariableHandle {
 public:
  /// From the handle to a variable of any type, implicitly.
  template <class T>
  AnyVarID(const VarID<T>& id)  // NOLINT(google-explicit-constructor): a VarID is one of any type
      : VariableHandle(id) {}
  /// Used by the library, for handles whose type only their store knows.
  explicit AnyVarID(const VariableHandle& handle) : VariableHandle(handle) {}

  /// Whether it is a VarID<T>.
  template <class T>
  bool is() const {
    return detail::holdsType<T>(store_.get());
  }
  /// The current value. Throws [slom.wrong-type] when it is not a T, [slom.stale-handle] as a VarID does.
  template <class T>
  const T& as() const {
    const void* const value = current();
    detail::requireType<T>(*store_);
    return *static_cast<const T*>(value);
  }
  /// The VarID that it was made of. Throws as `as` does.
  template <class T>
  VarID<T> id() const {
    as<T>();
    return VarID<T>(*this);
  }
  /// Degrees of freedom of the current value.
  int dof() const { return store_->dofOf(current()); }

  /// Used by the library. The current value; throws [slom.stale-handle].
  const void* current() const;
  /// Used by the library: where its value lies.
  const VariableStoreBase* store() const { return store_.get(); }

  friend bool operator==(const AnyVarID& a, const AnyVarID& b) { return a.equals(b); }
};

/// A variable of any type as a measurement function sees it: `x[0].as<Pose>().pos`.
class VariableView : public VariableArgument {
 public:
  /// Of the variable's current value; made by the library.
  explicit VariableView(const AnyVarID& id) : VariableArgument(id, id.current()) {}

  /// Whether the variable is a T.
  template <class T>
  bool is() const {
    return detail::holdsType<T>(store());
  }
  /// The value at which the measurement is evaluated. Throws [slom.wrong-type] when it is not a T.
  template <class T>
  const T& as() const {
    detail::requireType<T>(*store());
    return *static_cast<const T*>(value_);
  }
  /// Degrees of freedom of the value.
  int dof() const { return store()->dofOf(value_); }
};

}  // namespace slom
