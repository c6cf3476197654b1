// A text file as lines of words and numbers, fast enough for a million lines.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "slom/io/input_file.hpp"
#include "slom/io/numbered_lines.hpp"

namespace slom::io::g2o {

/// The lines of a file, one after another, and the words of each. Blank lines and lines that begin with # are skipped.
/// Lines end at a line feed; in a file without line feeds, at a carriage return. The file is read in large parts, so it
/// need not fit into memory and may be a pipe.
class Lines {
 public:
  /// Opens the file, whose name must outlive this object. Throws the errors of openInput, and [slom.io.bad-line] if a
  /// line is longer than 16 MiB.
  explicit Lines(const std::string& file);
  /// Takes some lines of the file. Both must outlive this object.
  Lines(const std::string& file, const NumberedLines& lines) : file_(file), given_(&lines) {}

  /// Moves to the next line with content. Returns false at the end.
  bool next();
  int lineNumber() const { return line_number_; }
  std::string_view tag() const { return tag_; }

  /// Sets the expected form of this line: `form` is an example, with `count` words after the tag.
  void expect(int count, const char* form);
  /// Reads the next word as the id of a vertex.
  std::uint64_t id();
  /// Reads the next word as a finite number.
  double number();
  /// Returns whether no words are left.
  bool atEnd() const;
  /// Throws if words are left.
  void finish() const;
  /// Throws [slom.io.bad-line] FILE:LINE: `what`.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  bool nextLine();
  bool readMore();
  void findEndOfLine();
  void require(bool good) const;
  std::string_view word();
  [[noreturn]] void failCount() const;

  const std::string& file_;
  const NumberedLines* given_ = nullptr;  // instead of the file
  int next_given_ = 0;
  InputStream stream_;
  std::vector<char> buffer_;
  char end_of_line_ = '\n';
  std::size_t begin_ = 0, end_ = 0;  // part of the buffer not handed out yet
  std::string_view line_;            // part of this line not read yet
  std::string_view after_tag_;       // the line after its tag
  std::string_view tag_;
  const char* form_ = "";
  int line_number_ = 0;
  int count_ = 0;  // number of words expected
  int word_ = 0;   // number of the word read last, from 1
};

}  // namespace slom::io::g2o
