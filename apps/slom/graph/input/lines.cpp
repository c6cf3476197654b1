#include "graph/input/lines.hpp"

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

#include <fmt/format.h>

#include "error.hpp"

namespace slom::app::graph {

namespace {

constexpr bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

void skipBlanks(std::string_view& text) {
  std::size_t n = 0;
  while (n < text.size() && isBlank(text[n])) ++n;
  text.remove_prefix(n);
}

/// The next word, taken off `text`; empty at its end.
std::string_view takeWord(std::string_view& text) {
  skipBlanks(text);
  std::size_t n = 0;
  while (n < text.size() && !isBlank(text[n])) ++n;
  const std::string_view word = text.substr(0, n);
  text.remove_prefix(n);
  return word;
}

/// Long words, of a file that is no graph, shortened for a message.
std::string shortened(std::string_view word) {
  return word.size() <= 40 ? std::string(word) : std::string(word.substr(0, 37)) + "...";
}

/// All of `word` read as a number.
template <class T>
bool parse(std::string_view word, T& value) {
  if (word.size() > 1 && word.front() == '+' && word[1] != '-') word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size();
}

}  // namespace

std::string readWhole(const std::string& file) {
  const auto close = [](std::FILE* stream) { std::fclose(stream); };
  const std::unique_ptr<std::FILE, decltype(close)> stream(std::fopen(file.c_str(), "rb"), close);
  const auto check = [&](bool good) {
    if (good) return;
    throw UserError(fmt::format("{}: cannot be read ({}); check the path", file, std::strerror(errno)));
  };
  check(stream != nullptr);
  constexpr std::size_t chunk = std::size_t{1} << 22;
  std::string text;
  for (std::size_t size = 0;;) {
    text.resize(size + std::max(chunk, size));
    const std::size_t got = std::fread(text.data() + size, 1, text.size() - size, stream.get());
    check(std::ferror(stream.get()) == 0);
    size += got;
    if (size < text.size()) return text.resize(size), text;
  }
}

Lines::Lines(const std::string& file, std::string_view text) : file_(file), rest_(text) {
  if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);
}

bool Lines::next() {
  while (!rest_.empty()) {
    const std::size_t end = rest_.find('\n');
    line_ = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    ++number_;
    word_ = 0;
    tag_ = takeWord(line_);
    behind_ = line_;
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
  for (std::string_view line = behind_; !takeWord(line).empty();) ++count;
  fail(fmt::format("there are {} words behind {} instead of {}; write \"{}\"", count, tag_, count_, form_));
}

std::string_view Lines::word() {
  ++word_;
  const std::string_view text = takeWord(line_);
  if (text.empty()) failCount();
  return text;
}

long Lines::id() {
  const std::string_view text = word();
  long value = 0;
  if (!parse(text, value) || value < 0) {
    fail(fmt::format("the id \"{}\" of {} is not a whole number from 0 on; correct it", shortened(text), tag_));
  }
  return value;
}

double Lines::number64() {
  const std::string_view text = word();
  double value = 0;
  if (parse(text, value) && std::isfinite(value)) return value;
  fail(fmt::format("word {} behind {} is \"{}\"; write a finite number there", word_, tag_, shortened(text)));
}

void Lines::fail(const std::string& what) const {
  throw UserError(fmt::format("{}:{}: {}", file_, number_, what));
}

}  // namespace slom::app::graph
