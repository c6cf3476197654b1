/// A growing array of values that may not be assignable, as callables with captures are not: what a pool needs of std::vector, in few functions,
/// which every program compiles for every kind of measurement.
#pragma once

#include <cstddef>
#include <new>
#include <utility>

#include "mtk/detail/cpp20.hpp"

namespace slom {

/// The values in the order in which they were appended. They may move when one is.
template <class T>
class GrowingArray {
 public:
  /// Empty.
  GrowingArray() = default;
  GrowingArray(const GrowingArray&) = delete;
  GrowingArray& operator=(const GrowingArray&) = delete;
  ~GrowingArray() {
    while (size_ > 0) data_[--size_].~T();
    ::operator delete(data_, std::align_val_t(alignof(T)));
  }

  /// The first one; the others follow.
  T* data() { return data_; }
  const T* data() const { return data_; }
  /// Value i.
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }

  /// Appends a value. Where this throws, nothing has changed.
  void push(T&& value) {
    if (size_ == capacity_) {
      GrowingArray larger;
      larger.capacity_ = capacity_ == 0 ? 1 : 2 * capacity_;
      larger.data_ =
          static_cast<T*>(::operator new(larger.capacity_ * sizeof(T), std::align_val_t(alignof(T))));
      for (; larger.size_ < size_; ++larger.size_) {
        ::new (static_cast<void*>(larger.data_ + larger.size_)) T(std::move_if_noexcept(data_[larger.size_]));
      }
      std::swap(data_, larger.data_);
      std::swap(capacity_, larger.capacity_);
    }
    ::new (static_cast<void*>(data_ + size_)) T(std::move(value));
    ++size_;
  }
  /// The last value takes the place of value i.
  void moveLastTo(std::size_t i) {
    T& last = data_[size_ - 1];
    if (i != size_ - 1) {
      data_[i].~T();
      ::new (static_cast<void*>(data_ + i)) T(std::move(last));
    }
    last.~T();
    --size_;
  }

 private:
  T* data_ = nullptr;
  std::size_t size_ = 0, capacity_ = 0;
};

}  // namespace slom
