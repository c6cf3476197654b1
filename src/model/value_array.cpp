#include "slom/model/value_array.hpp"

#include <new>

namespace slom {

ValueArray::~ValueArray() {
  for (std::byte* chunk : chunks_) ::operator delete(chunk, std::align_val_t(alignment_));
}

void* ValueArray::place() {
  if (size_ == chunks_.size() * kChunk) {
    chunks_.reserve(chunks_.size() + 1);
    chunks_.push_back(
        static_cast<std::byte*>(::operator new(kChunk* value_size_, std::align_val_t(alignment_))));
  }
  return (*this)[size_];
}

}  // namespace slom
