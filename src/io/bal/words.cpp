#include "io/bal/words.hpp"

#include <cmath>

#include <fmt/format.h>

#include "io/fault.hpp"
#include "slom/io/number.hpp"

namespace slom::io::bal {

namespace {

/// Returns whether c separates words or ends a line: '\n', '\t', '\r', ' ' and similar characters.
constexpr bool isSpace(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

constexpr std::size_t longest_word = 40;  // in a message; other kinds of files may have longer ones

}  // namespace

Words::Words(const std::string& file, std::string_view text)
    : file_(file), at_(text.data()), end_(text.data() + text.size()) {
  constexpr std::string_view mark = "\xEF\xBB\xBF";  // byte order
  if (text.starts_with(mark)) at_ += mark.size();
}

bool Words::next() {
  int lines = 0;
  for (; at_ != end_ && isSpace(*at_); ++at_) lines += isEndOfLine() ? 1 : 0;
  if (at_ == end_) return false;
  line_ += lines;
  const char* const first = at_;
  while (at_ != end_ && !isSpace(*at_)) ++at_;
  word_ = {first, std::size_t(at_ - first)};
  return true;
}

bool Words::moreOnLine() {
  while (at_ != end_ && isSpace(*at_) && !isEndOfLine()) ++at_;
  return at_ != end_ && !isEndOfLine();
}

bool Words::number(double& value) const { return parseNumber(word_, value) && std::isfinite(value); }

std::string Words::quoted() const { return std::string("\"") + shortened(word_, longest_word) + "\""; }

void Words::fail(const std::string& what) const { failAt("bad-line", file_, line_, what); }

}  // namespace slom::io::bal
