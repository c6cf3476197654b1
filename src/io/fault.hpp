// Errors of this folder: what is wrong, where, and the remedy.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "mtk/error.hpp"

namespace slom::io {

/// Throws [slom.io.`kind`] `sentence`; subject: the file, or file and line.
[[noreturn]] inline void fail(const char* kind, const std::string& sentence,
                              const std::string& subject = {}) {
  throw mtk::Error(std::string("slom.io.") + kind, sentence, subject);
}

/// Throws [slom.io.`kind`] `file`:`line`: `what`.
[[noreturn]] inline void failAt(const char* kind, const std::string& file, int line,
                                const std::string& what) {
  const std::string place = fmt::format("{}:{}", file, line);
  fail(kind, place + ": " + what, place);
}

/// Returns a text, or the first characters and three dots if it is longer than `most`. Bytes that are no text would end
/// a message, so they become question marks.
inline std::string shortened(std::string_view text, std::size_t most) {
  std::string part = text.size() <= most ? std::string(text) : std::string(text.substr(0, most - 3)) + "...";
  std::replace(part.begin(), part.end(), '\0', '?');
  return part;
}

}  // namespace slom::io
