// Numbers with their uncertainty, as people read them.
#pragma once

#include <cmath>
#include <string>

#include <fmt/format.h>

namespace slom::app::calib {

/// A number in a sentence or a table: formatted as double is, a dash where it is not finite.
struct Shown {
  double value;
};

/// A value with as many digits as its standard deviation makes worth printing (two of the latter).
///   532.7981, 0.21   ->  "532.80", "0.21"
///   std = 0          ->  six significant digits, "fixed"
///   std not finite   ->  six significant digits, "not determined"
struct ValueText {
  std::string value, std;
};
ValueText withStd(double value, double std);

/// Two significant digits, a dash where it is not finite; never in scientific notation unless tiny: "0.21",
/// "13", "0.00032", "2.1e-08".
std::string twoDigits(double number);

}  // namespace slom::app::calib

template <>
struct fmt::formatter<slom::app::calib::Shown> : fmt::formatter<double> {
  template <class Context>
  auto format(const slom::app::calib::Shown& number, Context& context) const {
    if (std::isfinite(number.value)) return fmt::formatter<double>::format(number.value, context);
    return fmt::format_to(context.out(), "-");
  }
};
