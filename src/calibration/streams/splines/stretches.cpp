#include "calibration/streams/splines/stretches.hpp"

#include <algorithm>
#include <utility>

#include "calibration/streams/check.hpp"

namespace slom::calibration {
namespace {

constexpr double longest_without_image =
    2;  // s; over longer times, readings alone hardly determine a position

using Times = std::pair<double, double>;

/// Returns the times in which an IMU has readings, in the clock of the cameras.
std::vector<Times> readTimes(const StartedImu& imu, double longest_gap) {
  const double offset = imu.start.offset;
  std::vector<Times> times;
  double from = imu.stream->samples.front().time;
  for (const auto& [before, after] : gapsOf(*imu.stream)) {
    if (after - before <= longest_gap) continue;
    times.emplace_back(from - offset, before - offset);
    from = after;
  }
  times.emplace_back(from - offset, imu.stream->samples.back().time - offset);
  return times;
}

/// Returns the union of intervals, in the order of time.
std::vector<Times> joined(std::vector<Times> times) {
  std::sort(times.begin(), times.end());
  std::vector<Times> all;
  for (const Times& one : times) {
    if (all.empty() || one.first > all.back().second) {
      all.push_back(one);
    } else {
      all.back().second = std::max(all.back().second, one.second);
    }
  }
  return all;
}

}  // namespace

std::vector<Stretch> stretchesOf(const std::vector<RigAtImage>& images, const std::vector<StartedImu>& imus,
                                 double knot_spacing) {
  std::vector<Times> times;
  for (const StartedImu& imu : imus) {
    const std::vector<Times> one = readTimes(imu, 2 * knot_spacing);
    times.insert(times.end(), one.begin(), one.end());
  }
  std::vector<Stretch> stretches;
  for (const Times& read : joined(std::move(times))) {
    bool is_new = true;
    for (std::size_t i = 0; i < images.size(); ++i) {
      const double time = images[i].time;
      if (time < read.first || time > read.second) continue;
      if (is_new || time - stretches.back().to > longest_without_image) stretches.push_back({time, time, {}});
      is_new = false;
      stretches.back().to = time;
      stretches.back().images.push_back(i);
    }
  }
  std::erase_if(stretches, [](const Stretch& one) { return one.images.size() < 2; });
  return stretches;
}

}  // namespace slom::calibration
