// Texts in files, and messages about malformed ones.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>

#include "slom/calibration/error.hpp"

namespace slom::calibration {

/// Throws [slom.calibration.bad-file].
[[noreturn]] inline void badFile(const std::string& sentence) {
  throw DataError("slom.calibration.bad-file", sentence);
}

inline constexpr std::size_t longest_quote = 60;  ///< number of characters that messages quote from files

/// Returns the path or, if it is a folder such as EuRoC's cam0 and imu0, the file of this name in it.
inline std::string inFolder(const std::string& path, const char* file) {
  std::error_code ignored;
  return std::filesystem::is_directory(path, ignored) ? (std::filesystem::path(path) / file).string() : path;
}

/// Returns the text without blanks at both ends.
inline std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  return first == std::string_view::npos ? std::string_view()
                                         : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// Returns the text, cut after `most` characters with three dots. Bytes that are not text would end a message, so
/// question marks replace them.
inline std::string shortened(std::string_view text, std::size_t most) {
  std::string part = text.size() <= most ? std::string(text) : std::string(text.substr(0, most - 3)) + "...";
  std::replace(part.begin(), part.end(), '\0', '?');
  return part;
}

}  // namespace slom::calibration
