// The bytes of a container: a head, a table of sections, the sections. Everything is words of 8 bytes, little endian.
//   word 0  magic, 1 byte order, 2 version, 3 content, 4 sections, 5 bytes of the file, 6 checksum of head and table
//   then for each section: name (3 words), whole, real, count, offset, checksum
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "slom/io/container.hpp"
#include "slom/io/word_hash.hpp"

namespace slom::io::container {

using Words = std::vector<std::uint64_t>;

constexpr std::size_t word_bytes = 8, head_words = 7, section_words = 8, name_words = 3, most_sections = 1000;
constexpr std::size_t checksum_word = 6;
/// A byte that begins no text, a name, and line ends that a transfer as text would change.
constexpr char magic[] = "\x89SLOM\r\n\x1A";
constexpr std::uint64_t byte_order = 0x0102030405060708, version = 1;

constexpr std::uint64_t swapped(std::uint64_t word) {
  std::uint64_t result = 0;
  for (int i = 0; i < 8; ++i) result = result << 8 | ((word >> (8 * i)) & 0xFF);
  return result;
}
/// Returns the word as it is in the file, or the word of the file as it is in memory.
constexpr std::uint64_t littleEndian(std::uint64_t word) {
  return std::endian::native == std::endian::little ? word : swapped(word);
}

/// Returns the checksum of head and table.
inline std::uint64_t checksumOf(const Words& head_and_table) {
  WordHash hash;
  for (std::size_t i = 0; i < head_and_table.size(); ++i) {
    if (i != checksum_word) hash.add(head_and_table[i]);
  }
  return hash.value();
}

inline std::uint64_t magicWord() {
  std::uint64_t word = 0;
  std::memcpy(&word, magic, word_bytes);
  return littleEndian(word);
}

/// Returns the hash of a record for the checksum of its section.
template <class WordRange>
std::uint64_t hashOfRecord(std::uint64_t number, const WordRange& words) {
  WordHash hash;
  hash.add(number);
  for (const std::uint64_t word : words) hash.add(word);
  return hash.value();
}

}  // namespace slom::io::container
