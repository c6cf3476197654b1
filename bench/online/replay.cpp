#include "online/replay.hpp"

#include <algorithm>
#include <numeric>

namespace slom::bench {

double Replay::total() const { return std::accumulate(seconds.begin(), seconds.end(), 0.0); }

double Replay::quantile(double share) const {
  if (seconds.empty()) return 0;
  std::vector<double> sorted = seconds;
  std::sort(sorted.begin(), sorted.end());
  const auto place = static_cast<std::size_t>(share * static_cast<double>(sorted.size()));
  return sorted[std::min(place, sorted.size() - 1)];
}

double Replay::largestGap() const {
  double largest = 0;
  for (const Check& check : checks) largest = std::max(largest, check.gap);
  return largest;
}

double Replay::largestPositionError() const {
  double largest = 0;
  for (const Check& check : checks) largest = std::max(largest, check.position_error);
  return largest;
}

}  // namespace slom::bench
