// Words for people, and numbers written by people.
#pragma once

#include <charconv>
#include <cstddef>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace slom::app {

/// Returns `1 image` or `2 images`.
std::string plural(std::size_t count, const std::string& noun);

/// Returns the text without blanks at both ends.
std::string_view trimmed(std::string_view text);

/// Reads all of `text` as a number, with an optional leading +.
template <class T>
bool parseNumber(std::string_view text, T& value) {
  if (text.size() > 1 && text.front() == '+' && text[1] != '-') text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

/// Returns `a, b and c` for the last separator " and ".
std::string listed(const std::vector<std::string>& words, std::string_view separator,
                   std::string_view last_separator);

/// Returns the sentence with a capital first letter, unless its first word is a name such as acc_bias.
std::string capitalised(std::string sentence);

/// Returns the text in lines of at most `width` characters, broken at spaces. Lines after the first begin with
/// `indent`, which does not count.
std::string wrapped(std::string_view text, std::size_t width, std::string_view indent = "");

/// Returns a sentence in lines of at most 100 characters, broken at spaces, the first with a bullet.
std::string bulleted(const std::string& sentence);

}  // namespace slom::app
