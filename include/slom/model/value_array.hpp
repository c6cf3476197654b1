/// ValueArray: a growing array of values whose type only its owner has. Its chunks of contiguous values never move.
#pragma once

#include <cstddef>
#include <vector>

#include "mtk/detail/cpp20.hpp"

namespace slom {

/// Memory only. The owner constructs each value in `place()`, counts it by `grow()` and destroys it at the end.
class ValueArray {
 public:
  /// Creates an array for values of this size and alignment [bytes].
  ValueArray(std::size_t value_size, std::size_t alignment)
      : value_size_(value_size), alignment_(alignment) {}
  ValueArray(const ValueArray&) = delete;
  ValueArray& operator=(const ValueArray&) = delete;
  ~ValueArray();

  std::size_t size() const { return size_; }
  void* operator[](std::size_t i) { return chunks_[i / kChunk] + (i % kChunk) * value_size_; }
  /// Returns value i.
  const void* at(std::size_t i) const { return chunks_[i / kChunk] + (i % kChunk) * value_size_; }
  /// Returns value i as a T.
  template <class T>
  T& as(std::size_t i) const {
    return reinterpret_cast<T*>(chunks_[i / kChunk])[i % kChunk];
  }
  /// Returns the place of the next value.
  void* place();
  /// Counts the value that was constructed in place().
  void grow() { ++size_; }

 private:
  static constexpr std::size_t kChunk = 256;
  std::size_t value_size_, alignment_;
  std::vector<std::byte*> chunks_;
  std::size_t size_ = 0;
};

}  // namespace slom
