/// A growing array whose elements never move: chunks of contiguous elements.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace slom {

template <class T>
class StableVector {
 public:
  StableVector() = default;
  StableVector(const StableVector&) = delete;
  StableVector& operator=(const StableVector&) = delete;
  ~StableVector() {
    for (std::size_t i = 0; i < size_; ++i) std::destroy_at(&(*this)[i]);
    for (T* chunk : chunks_) std::allocator<T>().deallocate(chunk, kChunk);
  }

  std::size_t size() const { return size_; }
  T& operator[](std::size_t i) { return chunks_[i / kChunk][i % kChunk]; }
  const T& operator[](std::size_t i) const { return chunks_[i / kChunk][i % kChunk]; }

  void push_back(T value) {
    if (size_ == chunks_.size() * kChunk) {
      chunks_.push_back(nullptr);
      try {
        chunks_.back() = std::allocator<T>().allocate(kChunk);
      } catch (...) {
        chunks_.pop_back();
        throw;
      }
    }
    std::construct_at(&(*this)[size_], std::move(value));
    ++size_;
  }

 private:
  static constexpr std::size_t kChunk = 256;
  std::vector<T*> chunks_;
  std::size_t size_ = 0;
};

}  // namespace slom
