// The median of numbers.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace slom::calibration {

/// Returns the median, the upper of the two middle numbers for an even count; 0 for an empty list.
inline double medianOf(std::vector<double> numbers) {
  if (numbers.empty()) return 0;
  const auto middle = numbers.begin() + std::ptrdiff_t(numbers.size() / 2);
  std::nth_element(numbers.begin(), middle, numbers.end());
  return *middle;
}

/// The median length of a vector in space whose components are normal with the standard deviation 1.
inline constexpr double median_of_length = 1.5382;

/// Estimates the standard deviation of u and of v from distances, assuming normal noise: the median distance, divided
/// by the median of a Rayleigh distribution.
inline double noiseOfDistances(std::vector<double> distances) {
  return medianOf(std::move(distances)) / std::sqrt(2 * std::log(2.0));
}

}  // namespace slom::calibration
