#include "io/g2o/lines.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "io/fault.hpp"
#include "slom/io/input_file.hpp"
#include "slom/io/number.hpp"

namespace slom::io::g2o {

namespace {

constexpr bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

void skipBlanks(std::string_view& text) {
  std::size_t n = 0;
  while (n < text.size() && isBlank(text[n])) ++n;
  text.remove_prefix(n);
}

/// Takes the next word off `text`; empty at its end.
std::string_view takeWord(std::string_view& text) {
  skipBlanks(text);
  std::size_t n = 0;
  while (n < text.size() && !isBlank(text[n])) ++n;
  const std::string_view word = text.substr(0, n);
  text.remove_prefix(n);
  return word;
}

constexpr std::size_t longest_line = std::size_t{1} << 24;
constexpr std::size_t longest_word = 40;  // in a message; other kinds of files may have longer ones

}  // namespace

Lines::Lines(const std::string& file) : file_(file), stream_(openInput(file)), buffer_(std::size_t{1} << 20) {
  readMore();
  constexpr std::string_view mark = "\xEF\xBB\xBF";  // byte order
  if (std::string_view(buffer_.data(), end_).starts_with(mark)) begin_ = mark.size();
  findEndOfLine();
}

void Lines::findEndOfLine() {
  const std::string_view text(buffer_.data(), end_);
  const std::size_t first = text.find_first_of("\r\n");
  if (first == std::string_view::npos || text[first] == '\n') return;
  const bool is_alone = first + 1 < text.size() && text[first + 1] != '\n';
  if (is_alone && text.find('\n') == std::string_view::npos) end_of_line_ = '\r';
}

void Lines::require(bool good) const {
  if (!good) cannotRead(file_);
}

/// Fills the buffer behind the part not handed out yet. Returns false at the end of the file.
bool Lines::readMore() {
  std::copy(buffer_.begin() + std::ptrdiff_t(begin_), buffer_.begin() + std::ptrdiff_t(end_),
            buffer_.begin());
  end_ -= begin_;
  begin_ = 0;
  if (end_ == longest_line) {
    ++line_number_;
    fail(fmt::format("the line is longer than {} bytes; this is not a pose graph", longest_line));
  }
  if (end_ == buffer_.size()) buffer_.resize(2 * buffer_.size());
  const std::size_t got = std::fread(buffer_.data() + end_, 1, buffer_.size() - end_, stream_.get());
  require(std::ferror(stream_.get()) == 0);
  end_ += got;
  return got > 0;
}

bool Lines::nextLine() {
  if (given_ != nullptr) {
    if (next_given_ == given_->size()) return false;
    line_ = (*given_)[next_given_];
    line_number_ = given_->number(next_given_++) - 1;
    return true;
  }
  for (std::size_t seen = 0;;) {
    const char* const first = buffer_.data() + begin_;
    const std::size_t size = end_ - begin_;
    const void* const found = std::memchr(first + seen, end_of_line_, size - seen);
    if (found != nullptr) {
      line_ = {first, std::size_t(static_cast<const char*>(found) - first)};
      begin_ += line_.size() + 1;
      return true;
    }
    seen = size;
    if (readMore()) continue;
    line_ = {buffer_.data(), size};
    begin_ = end_;
    return size > 0;
  }
}

bool Lines::next() {
  while (nextLine()) {
    ++line_number_;
    word_ = 0;
    tag_ = takeWord(line_);
    after_tag_ = line_;
    if (!tag_.empty() && tag_.front() != '#') return true;
  }
  return false;
}

void Lines::expect(int count, const char* form) {
  count_ = count;
  form_ = form;
}

bool Lines::atEnd() const {
  std::string_view line = line_;
  return takeWord(line).empty();
}

void Lines::finish() const {
  if (!atEnd()) failCount();
}

void Lines::failCount() const {
  int count = 0;
  for (std::string_view line = after_tag_; !takeWord(line).empty();) ++count;
  fail(fmt::format("there are {} words after {} instead of {}; write \"{}\"", count, tag_, count_, form_));
}

std::string_view Lines::word() {
  ++word_;
  const std::string_view text = takeWord(line_);
  if (text.empty()) failCount();
  return text;
}

std::uint64_t Lines::id() {
  const std::string_view text = word();
  std::uint64_t value = 0;
  if (!parseNumber(text, value)) {
    fail(fmt::format("the id \"{}\" of {} is not a whole number from 0 to 2^64 - 1; correct it",
                     shortened(text, longest_word), tag_));
  }
  return value;
}

double Lines::number() {
  const std::string_view text = word();
  double value = 0;
  if (parseNumber(text, value) && std::isfinite(value)) return value;
  fail(fmt::format("word {} after {} is \"{}\"; write a finite number there", word_, tag_,
                   shortened(text, longest_word)));
}

void Lines::fail(const std::string& what) const { failAt("bad-line", file_, line_number_, what); }

}  // namespace slom::io::g2o
