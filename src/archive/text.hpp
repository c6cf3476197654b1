/// Words of the archive's text.
#pragma once

#include <iomanip>
#include <istream>
#include <sstream>
#include <string>

namespace slom::archive_text {

inline constexpr int kVersion = 1;
inline constexpr const char* kFirstWords = "slom problem";

inline std::string inQuotes(const std::string& text) {
  std::ostringstream os;
  os << std::quoted(text);
  return os.str();
}

inline bool isAtEnd(std::istream& is) { return !is.fail() && (is >> std::ws).eof(); }

}  // namespace slom::archive_text
