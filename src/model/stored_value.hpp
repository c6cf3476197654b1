/// A copy of a variable's value, of any type.
#pragma once

#include <cstddef>
#include <new>

#include "slom/model/any_var_id.hpp"

namespace slom::detail {

class StoredValue {
 public:
  /// Copies `value`, which has the type of the variable.
  StoredValue(const AnyVarID& id, const void* value) : id_(id), place_(allocate()) {
    try {
      store().construct(place_, value);
    } catch (...) {
      free();
      throw;
    }
  }
  StoredValue(const StoredValue& other) : StoredValue(other.id_, other.place_) {}
  StoredValue& operator=(const StoredValue& other) {
    if (this != &other) StoredValue(other).swap(*this);
    return *this;
  }
  ~StoredValue() {
    store().destroy(place_);
    free();
  }

  const void* get() const { return place_; }
  const VariableStoreBase& store() const { return *id_.store(); }
  int dof() const { return store().dofOf(place_); }
  void swap(StoredValue& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(place_, other.place_);
  }

 private:
  std::align_val_t alignment() const { return std::align_val_t(store().alignment()); }
  void* allocate() const { return ::operator new(store().valueSize(), alignment()); }
  void free() { ::operator delete(place_, alignment()); }

  AnyVarID id_;  // keeps the store alive, which can destroy the value
  void* place_;
};

}  // namespace slom::detail
