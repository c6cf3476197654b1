/// Numbers with their uncertainty as text for people.
#pragma once

#include <string>

#include "mtk/detail/cpp20.hpp"

namespace slom::calibration {

/// Returns a number with this many decimals, for a sentence or a table; a dash if it is not finite.
std::string fixedDecimals(double number, int count);

/// A value with the digits that its standard deviation justifies (two digits of the standard deviation).
///   532.7981, 0.21   ->  "532.80", "0.21"
///   std = 0          ->  six significant digits, "fixed"
///   std not finite   ->  six significant digits, "not determined"
struct ValueText {
  std::string value, std;
};
/// Returns the texts of a value and its standard deviation, in the same unit.
ValueText withStd(double value, double std);

/// Returns two significant digits; a dash if the number is not finite. Scientific notation only for tiny numbers:
/// "0.21", "13", "0.00032", "2.1e-08".
std::string twoDigits(double number);

}  // namespace slom::calibration
