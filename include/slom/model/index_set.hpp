/// IndexSet: a set of small numbers in ascending order, with a bit for each number up to the largest. Adding and
/// removing take the same time for any size of the set.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mtk/detail/cpp20.hpp"

namespace slom {

/// The set.
class IndexSet {
 public:
  /// Visits the numbers in ascending order.
  class Iterator {
   public:
    /// Starts at the first number >= 64 * word, or at the end.
    Iterator(const std::vector<std::uint64_t>& words, std::size_t word) : words_(&words), word_(word) {
      skipEmptyWords();
    }
    int operator*() const { return static_cast<int>(64 * word_) + std::countr_zero(rest_); }
    Iterator& operator++() {
      rest_ &= rest_ - 1;
      if (rest_ == 0) {
        ++word_;
        skipEmptyWords();
      }
      return *this;
    }
    bool operator==(const Iterator& other) const { return word_ == other.word_ && rest_ == other.rest_; }

   private:
    void skipEmptyWords() {
      while (word_ < words_->size() && (*words_)[word_] == 0) ++word_;
      rest_ = word_ < words_->size() ? (*words_)[word_] : 0;
    }
    const std::vector<std::uint64_t>* words_;
    std::size_t word_;
    std::uint64_t rest_ = 0;  // remaining bits of this word; the lowest is the current number
  };

  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }
  Iterator begin() const { return {words_, empty() ? words_.size() : 0}; }
  Iterator end() const { return {words_, words_.size()}; }

  /// Adds i to the set or removes it. Does nothing if i is already there or already absent.
  void set(int i, bool is_in);

 private:
  std::vector<std::uint64_t> words_;
  std::size_t size_ = 0;
};

}  // namespace slom
