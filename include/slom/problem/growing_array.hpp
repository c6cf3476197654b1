/// GrowingArray: a growing array of values that need not be assignable, such as callables with captures. It has only
/// the functions of std::vector that a pool needs, because every program compiles them for every kind of measurement.
#pragma once

#include <cstddef>
#include <new>
#include <utility>

#include "mtk/detail/cpp20.hpp"

namespace slom {

/// The values in the order of appending. They may move when a value is appended.
template <class T>
class GrowingArray {
 public:
  /// Creates an empty array.
  GrowingArray() = default;
  GrowingArray(const GrowingArray&) = delete;
  GrowingArray& operator=(const GrowingArray&) = delete;
  ~GrowingArray() {
    while (size_ > 0) data_[--size_].~T();
    ::operator delete(data_, std::align_val_t(alignof(T)));
  }

  /// Returns a pointer to the first value; the others follow.
  T* data() { return data_; }
  const T* data() const { return data_; }
  /// Returns value i.
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }

  /// Appends a value. If this throws, nothing has changed.
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
  /// Moves the last value to the place of value i.
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
