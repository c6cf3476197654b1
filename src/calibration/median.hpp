// The median of numbers.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace slom::calibration {

/// The number that half of them are below, the upper one of the two in the middle; 0 of none.
inline double medianOf(std::vector<double> numbers) {
  if (numbers.empty()) return 0;
  const auto middle = numbers.begin() + std::ptrdiff_t(numbers.size() / 2);
  std::nth_element(numbers.begin(), middle, numbers.end());
  return *middle;
}

/// The standard deviation of u and of v that distances of normal noise show: their median over that of a Rayleigh distribution.
inline double noiseOfDistances(std::vector<double> distances) {
  return medianOf(std::move(distances)) / std::sqrt(2 * std::log(2.0));
}

}  // namespace slom::calibration
