#include "text.hpp"

#include <cctype>

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

std::string listed(const std::vector<std::string>& words, std::string_view separator,
                   std::string_view last_separator) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 < words.size() ? separator : last_separator;
    text += words[i];
  }
  return text;
}

std::string capitalised(std::string sentence) {
  if (sentence.substr(0, sentence.find(' ')).find('_') != std::string::npos) return sentence;
  sentence.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(sentence.front())));
  return sentence;
}

std::string wrapped(std::string_view text, std::size_t width, std::string_view indent) {
  std::string lines;
  std::size_t column = 0, begin = 0;
  while (begin < text.size()) {
    const std::string_view word = text.substr(begin, text.find(' ', begin) - begin);
    if (begin > 0) {
      const bool fits = column + 1 + word.size() <= width;
      lines += fits ? " " : "\n";
      if (!fits) lines += indent;
      column = fits ? column + 1 : 0;
    }
    lines += word;
    column += word.size();
    begin += word.size() + 1;
  }
  return lines;
}

std::string bulleted(const std::string& sentence) {
  constexpr std::size_t text_width = 96;
  return "  * " + wrapped(sentence, text_width, "    ") + "\n";
}

}  // namespace slom::app
