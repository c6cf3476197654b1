// A text in memory as words and numbers, each with its line; fast enough for millions of them.
#pragma once

#include <string>
#include <string_view>

namespace slom::io::bal {

class Words {
 public:
  /// Both must outlive this; `file` is for messages.
  Words(const std::string& file, std::string_view text);

  /// Goes to the next word; false at the end of the text, which then counts as being in the last line.
  bool next();
  /// The word that `next` found.
  std::string_view word() const { return word_; }
  /// The line of that word, from 1.
  int line() const { return line_; }
  /// Whether another word follows on the same line.
  bool moreOnLine();
  /// The word as a finite number; false when it is none.
  bool number(double& value) const;
  /// The word in quotes, cut where it is long.
  std::string quoted() const;
  /// Throws [slom.io.bad-line] FILE:LINE: `what`.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  /// Whether a line ends here: at a line feed, or at a carriage return without one.
  bool isEndOfLine() const { return *at_ == '\n' || (*at_ == '\r' && (at_ + 1 == end_ || at_[1] != '\n')); }

  const std::string& file_;
  const char* at_;
  const char* end_;
  std::string_view word_;
  int line_ = 1;
};

}  // namespace slom::io::bal
