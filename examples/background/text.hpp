#pragma once
#include <cstdio>
#include <string>
#include <type_traits>

/// Returns what printf would print.
template <class... Values>
std::string format(const char* format, const Values&... values) {
  static_assert(((std::is_arithmetic_v<Values> || std::is_convertible_v<Values, const char*>)&&...));
  char line[500];
  std::snprintf(line, sizeof line, format, values...);
  return line;
}
