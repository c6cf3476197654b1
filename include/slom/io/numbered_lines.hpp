/// NumberedLines: some lines of a text file, for files of which each process reads a part.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "mtk/detail/cpp20.hpp"

namespace slom::io {

/// Lines with their numbers in the file, in one piece of memory.
class NumberedLines {
 public:
  /// Adds a line, without its line feed.
  void add(std::string_view line, int number);
  int size() const { return static_cast<int>(lines_.size()); }
  std::string_view operator[](int i) const;
  /// Returns the number of line i in the file.
  int number(int i) const { return lines_[static_cast<std::size_t>(i)].number; }
  /// Adds `lines` to all numbers.
  void shift(int lines);
  /// Orders the lines by their numbers; lines with one number stay in their order.
  void sort();

  /// Returns the lines as bytes, for a message to another process.
  std::string bytes() const;
  /// Adds the lines of such a message.
  void addBytes(const std::string& bytes);

 private:
  struct Line {
    std::uint64_t begin;
    std::uint32_t size;
    int number;
  };
  std::string text_;
  std::vector<Line> lines_;
};

/// A part of a file.
struct PartOfFile {
  NumberedLines lines;  ///< with content; numbers count from 1 at the beginning of the part
  int line_count = 0;   ///< of all lines of the part
};

/// Reads the lines that begin in part `part` of `parts` with about the same number of bytes. Lines end at a line feed.
/// Blank lines and lines that begin with # are counted, but left out. Throws the errors of openInput, and
/// [slom.io.no-parts] for a pipe, which has no parts.
PartOfFile readLinesOfPart(const std::string& file, int part, int parts);

}  // namespace slom::io
