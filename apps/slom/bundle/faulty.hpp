// Items of a scene that have a fault.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <slom/base/collective.hpp>

namespace slom::app::bundle {

/// Items of one kind that have a fault: their count, and the numbers of the first ones.
class Faulty {
 public:
  explicit Faulty(const char* kind) : kind_(kind) {}

  /// Adds an item; call it with ascending numbers.
  void add(int number) {
    if (++count_ <= most_named_ + 1) first_.push_back(number);
  }
  /// Adds the items that other processes have found.
  void addUp(const Collective& processes);

  bool isEmpty() const { return count_ == 0; }
  std::size_t count() const { return count_; }
  /// Returns `2 points (numbers 3, 7)`.
  std::string text() const;
  /// Returns `3, 7`.
  std::string names() const;
  const char* choose(const char* for_one, const char* for_many) const {
    return count_ == 1 ? for_one : for_many;
  }

 private:
  static constexpr std::size_t most_named_ = 5;
  const char* kind_;
  std::size_t count_ = 0;
  std::vector<int> first_;  // ascending, at most one more than are named
};

}  // namespace slom::app::bundle
