#include "slom/model/index_set.hpp"

namespace slom {

void IndexSet::set(int i, bool is_in) {
  const std::size_t word = static_cast<std::size_t>(i) / 64;
  const std::uint64_t bit = std::uint64_t{1} << (static_cast<std::size_t>(i) % 64);
  if (word >= words_.size()) {
    if (!is_in) return;
    words_.resize(word + 1, 0);
  }
  if (((words_[word] & bit) != 0) == is_in) return;
  words_[word] ^= bit;
  size_ = is_in ? size_ + 1 : size_ - 1;
}

}  // namespace slom
