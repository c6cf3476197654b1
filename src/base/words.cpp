#include "base/words.hpp"

#include <charconv>
#include <cmath>
#include <system_error>

namespace slom {

std::string counted(int count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

std::string listed(const std::vector<std::string>& items, std::size_t most) {
  std::vector<std::string> shown = items;
  if (shown.size() > most) {
    shown.resize(most - 1);
    shown.push_back(std::to_string(items.size() - shown.size()) + " more");
  }
  std::string text;
  for (std::size_t i = 0; i < shown.size(); ++i)
    text += (i == 0 ? "" : i + 1 == shown.size() ? " and " : ", ") + shown[i];
  return text;
}

std::string abridged(const std::vector<std::string>& items) {
  constexpr std::size_t most = 4;
  std::string text;
  for (std::size_t i = 0; i < items.size(); ++i) {
    const bool hidden = items.size() > most && i >= 2 && i + 1 < items.size();
    if (!hidden) text += (text.empty() ? "" : ", ") + items[i];
    if (hidden && i == 2) text += ", ...";
  }
  return text;
}

std::string number(double x, int digits) {
  if (std::isnan(x)) return "nan";  // with either sign
  char text[40];
  const auto [end, error] = std::to_chars(text, text + sizeof text, x, std::chars_format::general, digits);
  return error == std::errc() ? std::string(text, end) : "nan";
}

}  // namespace slom
