/// Pimpl: owns the members of a class that only its source file defines.
#pragma once

#include <utility>

#include "mtk/detail/cpp20.hpp"

namespace slom::detail {

/// Owns a T that may be incomplete where the owning class is declared. It works like std::unique_ptr but without about
/// a hundred templates, which every program that includes the header would compile again for each T. OnEmpty is called
/// if the object is used after a move from it; OnEmpty throws.
template <class T, void (*OnEmpty)() = nullptr>
class Pimpl {
 public:
  explicit Pimpl(T* owned) : owned_(owned) {}
  Pimpl(Pimpl&& other) noexcept : owned_(std::exchange(other.owned_, nullptr)) {}
  Pimpl& operator=(Pimpl&& other) noexcept {
    if (this != &other) delete std::exchange(owned_, std::exchange(other.owned_, nullptr));
    return *this;
  }
  ~Pimpl() {
    static_assert(sizeof(T) > 0, "the source file that knows T defines the destructor of the owning class");
    delete owned_;
  }

  T* operator->() const {
    if constexpr (OnEmpty != nullptr) {
      if (owned_ == nullptr) OnEmpty();
    }
    return owned_;
  }
  T& operator*() const { return *operator->(); }
  explicit operator bool() const { return owned_ != nullptr; }

 private:
  T* owned_;
};

}  // namespace slom::detail
