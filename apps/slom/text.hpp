// Words for people to read, and numbers that they wrote.
#pragma once

#include <charconv>
#include <cstddef>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace slom::app {

/// `1 image`, `2 images`
std::string plural(std::size_t count, const std::string& noun);

/// Without blanks at both ends.
std::string_view trimmed(std::string_view text);

/// All of `text` read as a number; a + may stand before it.
template <class T>
bool parseNumber(std::string_view text, T& value) {
  if (text.size() > 1 && text.front() == '+' && text[1] != '-') text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

/// `a, b and c` with the last separator " and ".
std::string listed(const std::vector<std::string>& words, std::string_view separator,
                   std::string_view last_separator);

/// The sentence with a capital letter first, unless its first word is a name such as acc_bias.
std::string capitalised(std::string sentence);

/// The text as lines of at most `width` characters, broken at spaces; all but the first begin with `indent`, which does not count.
std::string wrapped(std::string_view text, std::size_t width, std::string_view indent = "");

/// A sentence as lines of at most 100 characters, broken at spaces, the first with a bullet.
std::string bulleted(const std::string& sentence);

}  // namespace slom::app
