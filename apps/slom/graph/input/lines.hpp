// A text file as lines of words and numbers, fast enough for a million of them.
#pragma once

#include <string>
#include <string_view>

namespace slom::app::graph {

/// All of a file; UserError when it cannot be read.
std::string readWhole(const std::string& file);

/// One line after the other, and the words of each. Blank lines and those that begin with # are skipped.
class Lines {
 public:
  /// `text` must outlive this; `file` is for messages.
  Lines(const std::string& file, std::string_view text);

  /// Goes to the next line that says something; false at the end.
  bool next();
  int number() const { return number_; }
  std::string_view tag() const { return tag_; }

  /// Says what this line must be: `form` is an example, with `count` words behind the tag.
  void expect(int count, const char* form);
  /// The next word as the id of a vertex.
  long id();
  /// The next word as a finite number.
  double number64();
  /// Whether there are words left.
  bool atEnd() const;
  /// Fails when there are words left.
  void finish() const;
  /// `FILE:LINE: ...`
  [[noreturn]] void fail(const std::string& what) const;

 private:
  std::string_view word();
  [[noreturn]] void failCount() const;

  const std::string& file_;
  std::string_view rest_;    // of the file, behind this line
  std::string_view line_;    // what of this line has not been read
  std::string_view behind_;  // the line behind its tag
  std::string_view tag_;
  const char* form_ = "";
  int number_ = 0;
  int count_ = 0;  // of words that are expected
  int word_ = 0;   // number of the last one read, from 1
};

}  // namespace slom::app::graph
