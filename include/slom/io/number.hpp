/// Numbers as people write them in files.
#pragma once

#include <charconv>
#include <string_view>
#include <system_error>

#include "mtk/detail/cpp20.hpp"

namespace slom::io {

/// Reads all of `text` as one number, in the notation of C for every locale; a + may precede it. `inf` and `nan` are
/// numbers. Returns false if the text is anything else or the number is out of range; `value` is then unspecified.
template <class T>
bool parseNumber(std::string_view text, T& value) {
  if (text.size() > 1 && text.front() == '+' && text[1] != '-') text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

}  // namespace slom::io
