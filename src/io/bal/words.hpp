// A text in memory as words and numbers, each with its line. It is fast enough for millions of them.
#pragma once

#include <string>
#include <string_view>

namespace slom::io::bal {

class Words {
 public:
  /// Reads `text`; `file` is its name in messages. Both must outlive this object.
  Words(const std::string& file, std::string_view text);

  /// Moves to the next word. Returns false at the end of the text; the end counts as part of the last line.
  bool next();
  /// Returns the word that next() found.
  std::string_view word() const { return word_; }
  /// Returns the line of that word, from 1.
  int line() const { return line_; }
  /// Returns whether another word follows on the same line.
  bool moreOnLine();
  /// Reads the word as a finite number. Returns false if it is none.
  bool number(double& value) const;
  /// Returns the word in quotes, shortened if it is long.
  std::string quoted() const;
  /// Throws [slom.io.bad-line] FILE:LINE: `what`.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  /// Returns whether a line ends here: at a line feed, or at a carriage return without one.
  bool isEndOfLine() const { return *at_ == '\n' || (*at_ == '\r' && (at_ + 1 == end_ || at_[1] != '\n')); }

  const std::string& file_;
  const char* at_;
  const char* end_;
  std::string_view word_;
  int line_ = 1;
};

}  // namespace slom::io::bal
