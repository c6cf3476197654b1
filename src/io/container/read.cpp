#include <algorithm>
#include <cerrno>
#include <unistd.h>

#include <fmt/format.h>
#include <sys/stat.h>

#include "io/container/layout.hpp"
#include "io/fault.hpp"
#include "slom/io/container.hpp"
#include "slom/io/input_file.hpp"

namespace slom::io {

namespace container {

namespace {

[[noreturn]] void refuseDamaged(const std::string& file, const std::string& what) {
  fail("damaged", fmt::format("{}: the container {}; convert the text file again", file, what), file);
}

/// Reads words at an offset. Returns false if the file ends before.
bool readWords(const InputStream& stream, const std::string& file, std::uint64_t offset, Words& words) {
  auto* bytes = reinterpret_cast<char*>(words.data());
  for (std::size_t rest = words.size() * word_bytes; rest > 0;) {
    const ssize_t got = ::pread(::fileno(stream.get()), bytes, rest, static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) cannotRead(file);
    if (got == 0) return false;
    bytes += got;
    offset += std::uint64_t(got);
    rest -= std::size_t(got);
  }
  for (std::uint64_t& word : words) word = littleEndian(word);
  return true;
}

std::uint64_t sizeOf(const InputStream& stream, const std::string& file) {
  struct stat status {};
  if (::fstat(::fileno(stream.get()), &status) != 0) cannotRead(file);
  return S_ISREG(status.st_mode) ? std::uint64_t(status.st_size) : 0;
}

void requireReadable(const Words& head, const std::string& file) {
  const auto refuse = [&](const std::string& what) {
    fail("other-container", fmt::format("{}: the container {}", file, what), file);
  };
  if (head[1] == swapped(byte_order))
    refuse("has numbers in the byte order of another kind of machine; convert the text file on this one");
  if (head[1] != byte_order) refuseDamaged(file, "is damaged in its head");
  if (head[2] != version)
    refuse(fmt::format(
        "has version {} of the format, but this slom reads version {}; convert the text file again", head[2],
        version));
}

ContainerSection sectionFrom(const std::uint64_t* words, const std::string& file, std::uint64_t size) {
  ContainerSection section;
  for (std::size_t i = 0; i < name_words; ++i) {
    const std::uint64_t word = littleEndian(words[i]);
    section.name.append(reinterpret_cast<const char*>(&word), word_bytes);
  }
  section.name.erase(std::min(section.name.find('\0'), section.name.size()));
  const std::uint64_t whole = words[3], real = words[4];
  section.count = words[5];
  section.offset = words[6];
  section.checksum = words[7];
  constexpr std::uint64_t most_words = 1000;
  const bool is_plausible = whole <= most_words && real <= most_words && whole + real > 0 &&
                            section.offset <= size &&
                            section.count <= (size - section.offset) / ((whole + real) * word_bytes);
  if (!is_plausible) refuseDamaged(file, "is damaged in its table");
  section.whole = int(whole);
  section.real = int(real);
  return section;
}

}  // namespace
}  // namespace container

bool isContainer(const std::string& file) {
  const InputStream stream = openInput(file);
  if (container::sizeOf(stream, file) < container::word_bytes) return false;
  container::Words first(1);
  return container::readWords(stream, file, 0, first) && first.front() == container::magicWord();
}

Container::Container(const std::string& file) : file_(file) {
  using namespace container;
  const InputStream stream = openInput(file);
  const std::uint64_t size = sizeOf(stream, file);
  Words words(head_words);
  if (size < head_words * word_bytes || !readWords(stream, file, 0, words))
    refuseDamaged(file, "ends within its head");
  if (words[0] != magicWord()) refuseDamaged(file, "is damaged in its head");
  requireReadable(words, file);
  const std::uint64_t count = words[4], announced = words[5], checksum = words[checksum_word];
  words.resize(head_words + section_words * std::min<std::uint64_t>(count, most_sections));
  if (!readWords(stream, file, 0, words) || size < announced)
    refuseDamaged(file, fmt::format("ends after {} of {} bytes", size, announced));
  if (count > most_sections || checksumOf(words) != checksum || size > announced)
    refuseDamaged(file, "is damaged in its head");
  content_ = ContainerContent(words[3]);
  for (std::uint64_t i = 0; i < count; ++i)
    sections_.push_back(sectionFrom(&words[head_words + section_words * i], file, size));
}

const ContainerSection& Container::section(std::string_view name, int whole, int real) const {
  for (const ContainerSection& section : sections_) {
    if (section.name == name && section.whole == whole && section.real == real) return section;
  }
  container::refuseDamaged(file_, fmt::format("has no section {}", name));
}

void Container::requireContent(ContainerContent content) const {
  if (content_ == content) return;
  const bool is_graph = content_ == ContainerContent::graph;
  fail("other-container",
       fmt::format("{}: the container has a {}; fit it by slom {}", file_,
                   is_graph ? "pose graph" : "bundle adjustment", is_graph ? "graph" : "bundle"),
       file_);
}

ContainerRange rangeOf(const ContainerSection& section, int part, int parts) {
  const auto P = std::uint64_t(parts), p = std::uint64_t(part);
  const std::uint64_t share = section.count / P, more = section.count % P;
  const std::uint64_t begin = share * p + std::min(more, p);
  return {begin, begin + share + (p < more ? 1 : 0)};
}

void Container::read(const ContainerSection& section, const ContainerRange& range, const Visit& visit) const {
  constexpr std::uint64_t piece_words = std::uint64_t{1} << 17;  // 1 MiB
  const auto width = std::uint64_t(section.words());
  const std::uint64_t piece = std::max<std::uint64_t>(1, piece_words / width);
  const InputStream stream = openInput(file_);
  container::Words words;
  for (std::uint64_t first = range.begin; first < range.end; first += piece) {
    const std::uint64_t count = std::min(piece, range.end - first);
    words.resize(count * width);
    if (!container::readWords(stream, file_, section.offset + first * width * container::word_bytes, words))
      container::refuseDamaged(file_, "became shorter while it was read");
    for (std::uint64_t i = 0; i < count; ++i) visit(first + i, {words.data() + i * width, width});
  }
}

std::uint64_t Container::sum(const ContainerSection& section, const ContainerRange& range) const {
  std::uint64_t sum = 0;
  read(section, range, [&](std::uint64_t number, std::span<const std::uint64_t> words) {
    sum += container::hashOfRecord(number, words);
  });
  return sum;
}

void Container::requireSum(const ContainerSection& section, std::uint64_t sum) const {
  if (sum != section.checksum)
    container::refuseDamaged(file_, fmt::format("is damaged in its section {}", section.name));
}

void Container::requireWhole() const {
  for (const ContainerSection& section : sections_) requireSum(section, sum(section, {0, section.count}));
}

}  // namespace slom::io
