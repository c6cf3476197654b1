#include "slom/calibration/number_text.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace slom::calibration {
namespace {

/// Returns the number of decimals that shows two significant digits of a positive number.
int decimalsOf(double number) {
  const int decimals = 1 - static_cast<int>(std::floor(std::log10(number)));
  const double rounded = std::round(number * std::pow(10, decimals));  // 0.0996 rounds to 0.10
  return std::max(0, rounded >= 100 ? decimals - 1 : decimals);
}

}  // namespace

std::string fixedDecimals(double number, int count) {
  return std::isfinite(number) ? fmt::format("{:.{}f}", number, std::max(count, 0)) : "-";
}

ValueText withStd(double value, double std) {
  if (!std::isfinite(value)) return {"-", "not determined"};
  if (std == 0) return {fmt::format("{:.6g}", value), "fixed"};
  if (!std::isfinite(std) || !(std > 0)) return {fmt::format("{:.6g}", value), "not determined"};
  const int decimals = decimalsOf(std);
  if (decimals > 9) return {fmt::format("{:.10g}", value), fmt::format("{:.1e}", std)};
  return {fmt::format("{:.{}f}", value, decimals), fmt::format("{:.{}f}", std, decimals)};
}

std::string twoDigits(double number) {
  const double size = std::abs(number);
  if (number == 0) return "0";
  if (!std::isfinite(number)) return "-";
  const int decimals = decimalsOf(size);
  return decimals > 6 ? fmt::format("{:.1e}", number) : fmt::format("{:.{}f}", number, decimals);
}

}  // namespace slom::calibration
