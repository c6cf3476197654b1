/// WordHash: a 64-bit checksum of words.
#pragma once

#include <bit>
#include <cstdint>

#include "mtk/detail/cpp20.hpp"

namespace slom::io {

/// A checksum of 64-bit words in their order. Sums of such hashes, modulo 2^64, do not depend on the order of the
/// records, so several processes can each hash a part. It finds damage and mix-ups, not forgeries.
class WordHash {
 public:
  /// Adds a word.
  WordHash& add(std::uint64_t word) {
    value_ = (value_ ^ word) * 0x9E3779B97F4A7C15U;
    value_ ^= value_ >> 32;
    return *this;
  }
  /// Adds the bits of a number.
  WordHash& add(double number) { return add(std::bit_cast<std::uint64_t>(number)); }
  /// Returns the hash of the words so far.
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0x736C6F6D;
};

}  // namespace slom::io
