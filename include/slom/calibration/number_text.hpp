/// Numbers with their uncertainty, as people read them.
#pragma once

#include <string>

#include "mtk/detail/cpp20.hpp"

namespace slom::calibration {

/// A number in a sentence or a table, with this many decimals; a dash where it is not finite.
std::string fixedDecimals(double number, int count);

/// A value with as many digits as its standard deviation makes worth printing (two of the latter).
///   532.7981, 0.21   ->  "532.80", "0.21"
///   std = 0          ->  six significant digits, "fixed"
///   std not finite   ->  six significant digits, "not determined"
struct ValueText {
  std::string value, std;
};
/// The texts of a value and its standard deviation, in the same unit.
ValueText withStd(double value, double std);

/// Two significant digits, a dash where it is not finite; never in scientific notation unless tiny: "0.21",
/// "13", "0.00032", "2.1e-08".
std::string twoDigits(double number);

}  // namespace slom::calibration
