#include "slom/io/numbered_lines.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <limits>

#include <sys/stat.h>

#include "io/fault.hpp"
#include "slom/io/input_file.hpp"

namespace slom::io {

void NumberedLines::add(std::string_view line, int number) {
  lines_.push_back({text_.size(), static_cast<std::uint32_t>(line.size()), number});
  text_ += line;
}

std::string_view NumberedLines::operator[](int i) const {
  const Line& line = lines_[static_cast<std::size_t>(i)];
  return std::string_view(text_).substr(line.begin, line.size);
}

void NumberedLines::shift(int lines) {
  for (Line& line : lines_) line.number += lines;
}

void NumberedLines::sort() {
  std::stable_sort(lines_.begin(), lines_.end(),
                   [](const Line& a, const Line& b) { return a.number < b.number; });
}

std::string NumberedLines::bytes() const {
  const std::uint64_t count = lines_.size();
  std::string bytes(sizeof count + count * sizeof(Line), '\0');
  std::memcpy(bytes.data(), &count, sizeof count);
  if (count > 0) std::memcpy(bytes.data() + sizeof count, lines_.data(), count * sizeof(Line));
  return bytes + text_;
}

void NumberedLines::addBytes(const std::string& bytes) {
  std::uint64_t count = 0;
  std::memcpy(&count, bytes.data(), sizeof count);
  const std::size_t before = lines_.size();
  lines_.resize(before + count);
  if (count > 0) std::memcpy(&lines_[before], bytes.data() + sizeof count, count * sizeof(Line));
  for (std::size_t i = before; i < lines_.size(); ++i) lines_[i].begin += text_.size();
  text_.append(bytes, sizeof count + count * sizeof(Line), std::string::npos);
}

namespace {

constexpr std::size_t kBuffer = std::size_t{1} << 20, kLongestLine = std::size_t{1} << 24;

/// Returns whether a line has content.
bool hasContent(std::string_view line) {
  const std::size_t first = line.find_first_not_of(" \t\r");
  return first != std::string_view::npos && line[first] != '#';
}

/// Throws for a file of bzip2 or gzip. `stream` is at its begin and stays there.
void requireNotCompressed(const std::string& file, const InputStream& stream) {
  char first[3] = {};
  const bool is_read = std::fread(first, 1, sizeof first, stream.get()) == sizeof first;
  std::rewind(stream.get());
  const std::string_view bytes(first, is_read ? sizeof first : 0);
  const char* const program = bytes == "BZh" ? "bzip2" : bytes.starts_with("\x1F\x8B") ? "gzip" : nullptr;
  if (program == nullptr) return;
  fail("no-parts",
       fmt::format("{}: compressed by {}, so no part can be read without the rest; decompress it", file,
                   program),
       file);
}

}  // namespace

PartOfFile readLinesOfPart(const std::string& file, int part, int parts) {
  const InputStream stream = openInput(file);
  struct stat status {};
  if (::fstat(::fileno(stream.get()), &status) != 0) cannotRead(file);
  if (S_ISDIR(status.st_mode)) {
    errno = EISDIR;
    cannotRead(file);
  }
  if (!S_ISREG(status.st_mode))
    fail("no-parts", file + ": this is a pipe, of which processes cannot read a part each; give a file",
         file);
  const auto size = static_cast<std::uint64_t>(status.st_size), P = static_cast<std::uint64_t>(parts);
  const std::uint64_t begin =
      size / P * std::uint64_t(part) + std::min<std::uint64_t>(size % P, std::uint64_t(part));
  const std::uint64_t end = begin + size / P + (std::uint64_t(part) < size % P ? 1 : 0);
  PartOfFile result;
  if (begin == end) return result;
  // A line belongs to the part in which its first byte is, so the part begins after the first line feed from the byte
  // before it.
  std::uint64_t at = begin == 0 ? 0 : begin - 1;
  if (::fseeko(stream.get(), static_cast<off_t>(at), SEEK_SET) != 0) cannotRead(file);
  bool is_inside = begin == 0;
  if (begin == 0) requireNotCompressed(file, stream);
  std::string buffer;
  std::size_t from = 0;
  for (;;) {
    const std::size_t feed = buffer.find('\n', from);
    if (feed != std::string::npos) {
      if (is_inside && at >= end) return result;
      const std::string_view line(buffer.data() + from, feed - from);
      if (is_inside && hasContent(line)) result.lines.add(line, result.line_count + 1);
      if (is_inside) ++result.line_count;
      at += line.size() + 1;
      is_inside = true;
      from = feed + 1;
      continue;
    }
    if (is_inside && at >= end) return result;
    buffer.erase(0, from);
    from = 0;
    if (buffer.size() > kLongestLine)
      fail("bad-line",
           fmt::format("{}: a line is longer than {} bytes; give a text file", file, kLongestLine), file);
    const std::size_t had = buffer.size();
    buffer.resize(had + kBuffer);
    const std::size_t got = std::fread(buffer.data() + had, 1, kBuffer, stream.get());
    if (std::ferror(stream.get()) != 0) cannotRead(file);
    buffer.resize(had + got);
    if (got > 0) continue;
    if (is_inside && !buffer.empty()) {
      if (hasContent(buffer)) result.lines.add(buffer, result.line_count + 1);
      ++result.line_count;
    }
    return result;
  }
}

}  // namespace slom::io
