#include "calibration/files/times.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>
#include <utility>

#include "calibration/files/text.hpp"
#include "slom/io/number.hpp"

namespace slom::calibration {
namespace {

constexpr std::string_view digits_of_numbers = "0123456789";

/// Returns the name in small letters, without what programs put around names: "#timestamp [ns]".
std::string plainName(std::string_view column) {
  std::string name;
  for (const char c : trimmed(column)) {
    if (c != '#' && c != '"' && c != '\'') name += char(std::tolower(static_cast<unsigned char>(c)));
  }
  return std::string(trimmed(name));
}

/// Reads a number in any notation, rounded.
std::optional<std::int64_t> roundedNanoseconds(const std::string& text, double unit_ns) {
  constexpr double most = 9e18;
  double value = 0;
  if (!io::parseNumber(std::string_view(text), value) || !(std::abs(value * unit_ns) < most)) return {};
  return std::int64_t(std::llround(value * unit_ns));
}

}  // namespace

std::optional<TimeUnit> timeUnitIn(std::string_view column) {
  std::string name = plainName(column);
  const bool has_bracket = name.ends_with(']') || name.ends_with(')');
  if (has_bracket) name.pop_back();
  const std::size_t end = name.find_last_of(has_bracket ? "[(" : "_");
  if (end == std::string::npos) return {};
  const std::string unit(trimmed(std::string_view(name).substr(end + 1)));
  const std::string what(trimmed(std::string_view(name).substr(0, end)));
  const bool is_time =
      what == "t" || what.find("time") != std::string::npos || what.find("stamp") != std::string::npos;
  if (!is_time) return {};
  for (const auto& [word, found] : {std::pair("s", TimeUnit::s),
                                    {"sec", TimeUnit::s},
                                    {"ms", TimeUnit::ms},
                                    {"us", TimeUnit::us},
                                    {"\xC2\xB5s", TimeUnit::us},  // the micro sign
                                    {"\xCE\xBCs", TimeUnit::us},  // the Greek letter
                                    {"ns", TimeUnit::ns}}) {
    if (unit == word) return found;
  }
  return {};
}

std::optional<std::int64_t> nanosecondsIn(std::string_view given, TimeUnit unit) {
  std::string text(given);
  if (const std::size_t comma = text.find(','); comma != std::string::npos) text[comma] = '.';
  const auto places = std::size_t(unit);
  const std::size_t point = std::min(text.find('.'), text.size());
  const std::string rest = text.substr(std::min(point + 1, text.size()));
  const std::string whole = text.substr(0, point);
  const std::size_t first = std::min(whole.find_first_not_of("+-"), whole.size());
  if (first > 1 || first == whole.size()) return roundedNanoseconds(text, std::pow(10, double(places)));
  if ((whole.substr(first) + rest).find_first_not_of(digits_of_numbers) != std::string::npos)
    return roundedNanoseconds(text, std::pow(10, double(places)));
  std::string all = whole + rest.substr(0, places);
  all.append(places - std::min(places, rest.size()), '0');
  std::int64_t time = 0;
  if (!io::parseNumber(std::string_view(all), time)) return {};
  return time;
}

}  // namespace slom::calibration
