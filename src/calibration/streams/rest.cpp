#include "calibration/streams/rest.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace slom::calibration {
namespace {

constexpr double window = 0.5, shortest_rest = 5;      // s
constexpr double most_turn = 0.01, most_force = 0.15;  // spread within a window [rad/s], [m/s^2]

/// Sums of readings up to each sample, for means and spreads of windows.
class Sums {
 public:
  explicit Sums(const std::vector<ImuSample>& samples)
      : sums_(samples.size() + 1, Reading::Zero()), squares_(sums_) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      Reading reading;
      reading << samples[i].gyro.array(), samples[i].force.array();
      reading -= first_ = i == 0 ? reading : first_;  // small numbers keep their digits
      sums_[i + 1] = sums_[i] + reading;
      squares_[i + 1] = squares_[i] + reading.square();
    }
  }
  using Reading = Eigen::Array<double, 6, 1>;
  Reading mean(std::size_t from, std::size_t to) const {
    return (sums_[to] - sums_[from]) / double(to - from);
  }
  /// Returns whether the readings from one sample to another vary as noise does.
  bool isRest(std::size_t from, std::size_t to) const {
    const Reading variance = (squares_[to] - squares_[from]) / double(to - from) - mean(from, to).square();
    return variance.head<3>().sum() < most_turn * most_turn &&
           variance.tail<3>().sum() < most_force * most_force;
  }

 private:
  Reading first_ = Reading::Zero();
  std::vector<Reading> sums_, squares_;
};

/// Returns the samples of the longest time in which all windows are at rest.
std::pair<std::size_t, std::size_t> longestRest(const std::vector<ImuSample>& samples, const Sums& sums) {
  std::pair<std::size_t, std::size_t> longest{0, 0};
  std::size_t begin = 0, end = 0;
  while (end < samples.size()) {
    const std::size_t first = end;
    while (end < samples.size() && samples[end].time - samples[first].time < window) ++end;
    const bool goes_on = end - first > 3 && sums.isRest(first, end);
    if (!goes_on) begin = end;
    if (end - begin > longest.second - longest.first) longest = {begin, end};
  }
  return longest;
}

}  // namespace

void addRest(const ImuStream& imu, ImuStreamResult& result) {
  const std::vector<ImuSample>& samples = imu.samples;
  const Sums sums(samples);
  const auto [begin, end] = longestRest(samples, sums);
  if (begin == end || samples[end - 1].time - samples[begin].time < shortest_rest) return;
  result.rest_from = samples[begin].time;
  result.rest_to = samples[end - 1].time;
  const double spacing = (result.rest_to - result.rest_from) / double(end - 1 - begin);
  constexpr std::size_t fewest_means = 9;
  for (std::size_t count = 1; fewest_means * count <= end - begin;
       count += std::max<std::size_t>(1, count / 4)) {
    Sums::Reading squares = Sums::Reading::Zero();
    double pairs = 0;
    for (std::size_t i = begin; i + 2 * count <= end; ++i) {  // overlapping
      squares += (sums.mean(i + count, i + 2 * count) - sums.mean(i, i + count)).square();
      ++pairs;
    }
    const Sums::Reading variance = squares / (2 * pairs);
    result.at_rest.push_back({double(count) * spacing, std::sqrt(variance.head<3>().mean()),
                              std::sqrt(variance.tail<3>().mean())});
  }
}

}  // namespace slom::calibration
