// A text file as lines of words and numbers, fast enough for a million of them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "slom/io/input_file.hpp"

namespace slom::io::g2o {

/// One line after the other, and the words of each. Blank lines and those that begin with # are skipped. Lines end by a line feed; in a file
/// without line feeds, by a carriage return.
/// Reads a large part of the file at a time, so that it need not fit into memory, and takes pipes too.
class Lines {
 public:
  /// Throws the errors of openInput, and [slom.io.bad-line] where a line is longer than 16 MiB. `file` must outlive this.
  explicit Lines(const std::string& file);

  /// Goes to the next line that says something; false at the end.
  bool next();
  int lineNumber() const { return line_number_; }
  std::string_view tag() const { return tag_; }

  /// Says what this line must be: `form` is an example, with `count` words after the tag.
  void expect(int count, const char* form);
  /// The next word as the id of a vertex.
  std::uint64_t id();
  /// The next word as a finite number.
  double number();
  /// Whether there are words left.
  bool atEnd() const;
  /// Fails when there are words left.
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
  InputStream stream_;
  std::vector<char> buffer_;
  char end_of_line_ = '\n';
  std::size_t begin_ = 0, end_ = 0;  // what of the buffer has not been handed out yet
  std::string_view line_;            // what of this line has not been read
  std::string_view after_tag_;       // the line after its tag
  std::string_view tag_;
  const char* form_ = "";
  int line_number_ = 0;
  int count_ = 0;  // number of words expected
  int word_ = 0;   // number of the last one read, from 1
};

}  // namespace slom::io::g2o
