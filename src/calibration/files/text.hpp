// Texts in files, and what is said of those that are not as they should be.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "slom/calibration/error.hpp"

namespace slom::calibration {

/// Throws [slom.calibration.bad-file].
[[noreturn]] inline void badFile(const std::string& sentence) {
  throw DataError("slom.calibration.bad-file", sentence);
}

inline constexpr std::size_t longest_quote = 60;  ///< of what files hold, in messages

/// Without blanks at both ends.
inline std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  return first == std::string_view::npos ? std::string_view()
                                         : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// The first characters of a text that is longer than `most`, and three dots. Bytes of no text, which would end a message, are question marks.
inline std::string shortened(std::string_view text, std::size_t most) {
  std::string part = text.size() <= most ? std::string(text) : std::string(text.substr(0, most - 3)) + "...";
  std::replace(part.begin(), part.end(), '\0', '?');
  return part;
}

}  // namespace slom::calibration
