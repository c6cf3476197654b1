// The median of numbers.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace slom::calibration {

/// The number that half of them are below, the upper one of the two in the middle; 0 of none.
inline double medianOf(std::vector<double> numbers) {
  if (numbers.empty()) return 0;
  const auto middle = numbers.begin() + std::ptrdiff_t(numbers.size() / 2);
  std::nth_element(numbers.begin(), middle, numbers.end());
  return *middle;
}

}  // namespace slom::calibration
