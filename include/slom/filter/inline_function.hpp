/// InlineFunction: a copy of any callable in memory of fixed size.
#pragma once

#include <cstddef>
#include <new>
#include <utility>

#include "mtk/detail/cpp20.hpp"

namespace slom::detail {

template <class Signature, std::size_t Bytes>
class InlineFunction;

template <class R, class... A, std::size_t Bytes>
class InlineFunction<R(A...), Bytes> {
 public:
  InlineFunction() = default;
  template <class F>
  explicit InlineFunction(const F& f) {
    static_assert(
        sizeof(F) <= Bytes,
        "slom: what this function captures does not fit into the history: capture less, or state more bytes, as "
        "in slom::FilterHistory<Filter, 32, 512>");
    static_assert(
        alignof(F) <= alignof(std::max_align_t),
        "slom: what this function captures needs more alignment than the history has: capture plain numbers and "
        "mtk::vect");
    new (memory_) F(f);
    call_ = [](const void* self, A... arguments) -> R {
      return (*static_cast<const F*>(self))(std::forward<A>(arguments)...);
    };
    copy_ = [](void* to, const void* from) { new (to) F(*static_cast<const F*>(from)); };
    destroy_ = [](void* self) { static_cast<F*>(self)->~F(); };
  }
  InlineFunction(const InlineFunction& other) { take(other); }
  InlineFunction& operator=(const InlineFunction& other) {
    if (this != &other) {
      clear();
      take(other);
    }
    return *this;
  }
  ~InlineFunction() { clear(); }

  R operator()(A... arguments) const { return call_(memory_, std::forward<A>(arguments)...); }

 private:
  void take(const InlineFunction& other) {
    if (other.copy_ != nullptr) other.copy_(memory_, other.memory_);
    call_ = other.call_;
    copy_ = other.copy_;
    destroy_ = other.destroy_;
  }
  void clear() {
    if (destroy_ != nullptr) destroy_(memory_);
    call_ = nullptr;
    copy_ = nullptr;
    destroy_ = nullptr;
  }

  alignas(std::max_align_t) std::byte memory_[Bytes];
  R (*call_)(const void*, A...) = nullptr;
  void (*copy_)(void*, const void*) = nullptr;
  void (*destroy_)(void*) = nullptr;
};

}  // namespace slom::detail
