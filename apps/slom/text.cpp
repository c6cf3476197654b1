#include "text.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace slom::app {

std::string plural(std::size_t count, const std::string& noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::string shortened(std::string_view text, std::size_t most) {
  return text.size() <= most ? std::string(text) : std::string(text.substr(0, most - 3)) + "...";
}

std::string bulleted(const std::string& sentence) {
  constexpr std::size_t text_width = 100;
  std::string text = "  *";
  std::size_t column = 3, begin = 0;
  while (begin < sentence.size()) {
    const std::size_t end = std::min(sentence.find(' ', begin), sentence.size());
    if (column + 1 + end - begin > text_width) text += "\n   ", column = 3;
    text += ' ';
    text.append(sentence, begin, end - begin);
    column += 1 + end - begin;
    begin = end + 1;
  }
  return text + "\n";
}

}  // namespace slom::app
