#include <algorithm>
#include <cerrno>
#include <cstring>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "io/container/layout.hpp"
#include "io/fault.hpp"
#include "slom/io/container.hpp"

namespace slom::io {

namespace container {

namespace {

void writeWords(int descriptor, const std::string& file, std::uint64_t offset, Words words) {
  for (std::uint64_t& word : words) word = littleEndian(word);
  const auto* bytes = reinterpret_cast<const char*>(words.data());
  for (std::size_t rest = words.size() * word_bytes; rest > 0;) {
    const ssize_t written = ::pwrite(descriptor, bytes, rest, static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0)
      fail("cannot-write",
           fmt::format("{}: cannot be written ({}); check the space on its disk", file, std::strerror(errno)),
           file);
    bytes += written;
    offset += std::uint64_t(written);
    rest -= std::size_t(written);
  }
}

void appendName(Words& words, const std::string& name) {
  char bytes[name_words * word_bytes] = {};
  std::memcpy(bytes, name.data(), std::min(name.size(), sizeof bytes));
  for (std::size_t i = 0; i < name_words; ++i) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes + i * word_bytes, word_bytes);
    words.push_back(littleEndian(word));
  }
}

}  // namespace
}  // namespace container

ContainerWriter::ContainerWriter(int descriptor, std::string file, ContainerContent content,
                                 std::vector<ContainerSection> sections)
    : descriptor_(descriptor),
      file_(std::move(file)),
      content_(content),
      sections_(std::move(sections)),
      written_(sections_.size(), 0),
      buffers_(sections_.size()) {
  std::uint64_t offset =
      (container::head_words + container::section_words * sections_.size()) * container::word_bytes;
  for (ContainerSection& section : sections_) {
    section.offset = offset;
    section.checksum = 0;
    offset += section.count * std::uint64_t(section.words()) * container::word_bytes;
  }
}

void ContainerWriter::add(std::size_t section, std::span<const std::uint64_t> words) {
  constexpr std::size_t piece_words = std::size_t{1} << 17;  // 1 MiB
  ContainerSection& to = sections_[section];
  std::vector<std::uint64_t>& buffer = buffers_[section];
  to.checksum += container::hashOfRecord(written_[section] + buffer.size() / std::size_t(to.words()), words);
  buffer.insert(buffer.end(), words.begin(), words.end());
  if (buffer.size() >= piece_words) flush(section);
}

void ContainerWriter::flush(std::size_t section) {
  const auto width = std::uint64_t(sections_[section].words());
  std::vector<std::uint64_t>& buffer = buffers_[section];
  const std::uint64_t records = buffer.size() / width;
  container::writeWords(descriptor_, file_,
                        sections_[section].offset + written_[section] * width * container::word_bytes,
                        std::move(buffer));
  written_[section] += records;
  buffer.clear();
}

void ContainerWriter::finish() {
  using namespace container;
  for (std::size_t i = 0; i < sections_.size(); ++i) flush(i);
  std::uint64_t size = (head_words + section_words * sections_.size()) * word_bytes;
  Words words{magicWord(), byte_order, version, std::uint64_t(content_), sections_.size(), 0, 0};
  for (std::size_t i = 0; i < sections_.size(); ++i) {
    const ContainerSection& section = sections_[i];
    if (written_[i] != section.count)
      fail("cannot-write",
           fmt::format(
               "{}: {} records {} were announced, but {} came; this is a fault of the program that writes it",
               file_, section.count, section.name, written_[i]),
           file_);
    appendName(words, section.name);
    words.insert(words.end(), {std::uint64_t(section.whole), std::uint64_t(section.real), section.count,
                               section.offset, section.checksum});
    size += section.count * std::uint64_t(section.words()) * word_bytes;
  }
  words[5] = size;
  words[checksum_word] = checksumOf(words);
  writeWords(descriptor_, file_, 0, words);
}

}  // namespace slom::io
