#include "slom/analyze/long_memory.hpp"

#include <algorithm>
#include <cmath>

namespace slom {

double longMemoryFactor(const std::vector<double>& variances, int groups, int length) {
  constexpr std::size_t doublings = 2;  // to estimate the power from
  constexpr double largest_power = 0.8;
  if (variances.size() <= doublings + 1) return 1;
  const double growth = variances.back() / variances[variances.size() - 1 - doublings];
  if (!(growth > 0) || !std::isfinite(growth)) return 1;
  const double power = std::clamp(std::log2(growth) / doublings, 0.0, largest_power);
  const double blocks = double(groups) / length;
  return std::pow(blocks, power) / (1 - std::pow(blocks, power - 1));
}

}  // namespace slom
