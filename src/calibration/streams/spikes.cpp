#include "calibration/streams/spikes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibration/median.hpp"
#include "calibration/streams/check.hpp"

namespace slom::calibration {
namespace {

constexpr double much = 30;          // second difference over the usual one; knocks of a rig by hand reach 20
constexpr std::size_t near = 3;      // readings on each side that a spike may change
constexpr std::size_t far = 15;      // readings on each side, beyond the near ones, that say what is usual
constexpr std::size_t fewest = 100;  // readings in all

/// Returns the standard deviation of normal numbers from the magnitude that a tenth of them exceed.
double scaleOf(std::vector<double> magnitudes) {
  constexpr double exceeded_by_a_tenth = 1.645;
  if (magnitudes.empty()) return 0;
  const auto at = magnitudes.begin() + std::ptrdiff_t(9 * (magnitudes.size() - 1) / 10);
  std::nth_element(magnitudes.begin(), at, magnitudes.end());
  return *at / exceeded_by_a_tenth;
}

/// Returns the readings of an axis: 0 to 2 of the gyroscope, 3 to 5 of the accelerometer.
std::vector<double> axisOf(const ImuStream& imu, int axis) {
  std::vector<double> values;
  for (const ImuSample& sample : imu.samples)
    values.push_back(axis < 3 ? sample.gyro[axis] : sample.force[axis - 3]);
  return values;
}

/// Returns which readings have neighbours at the usual intervals: the others are beside a gap.
std::vector<bool> neighboursOf(const ImuStream& imu) {
  constexpr double usual = 1.5;  // times the median
  std::vector<double> intervals;
  for (std::size_t i = 1; i < imu.samples.size(); ++i)
    intervals.push_back(imu.samples[i].time - imu.samples[i - 1].time);
  const double longest = usual * medianOf(intervals);
  std::vector<bool> has_both(imu.samples.size(), false);
  for (std::size_t i = 1; i < intervals.size(); ++i)
    has_both[i] = intervals[i - 1] < longest && intervals[i] < longest;
  return has_both;
}

/// Returns how far each value is from the mean of its neighbours; 0 beside a gap.
std::vector<double> differencesOf(const std::vector<double>& values,
                                  const std::vector<bool>& has_neighbours) {
  std::vector<double> differences(values.size(), 0);
  for (std::size_t i = 1; i + 1 < values.size(); ++i) {
    if (has_neighbours[i]) differences[i] = values[i] - (values[i - 1] + values[i + 1]) / 2;
  }
  return differences;
}

/// Returns the usual magnitude around i, without those that a spike at i changes.
double usualAround(const std::vector<double>& magnitudes, std::size_t i) {
  std::vector<double> around;
  for (std::size_t k = i > far ? i - far : 0; k <= i + far && k < magnitudes.size(); ++k) {
    if (k + near < i || k > i + near) around.push_back(magnitudes[k]);
  }
  return scaleOf(std::move(around));
}

/// Adds the spikes of one axis: a spike changes the differences of its neighbours, too.
void addSpikes(const std::vector<double>& values, const std::vector<bool>& has_neighbours,
               const ImuSpike& axis, const ImuStream& imu, std::vector<ImuSpike>& spikes) {
  const std::vector<double> differences = differencesOf(values, has_neighbours);
  std::vector<double> magnitudes;
  for (const double d : differences) magnitudes.push_back(std::abs(d));
  const double usual = scaleOf(magnitudes);
  const auto jumps = [&](std::size_t i) {
    return usual > 0 && magnitudes[i] > much * usual && magnitudes[i] > much * usualAround(magnitudes, i);
  };
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::size_t end = i;
    while (end < values.size() && jumps(end)) ++end;
    if (end == i) continue;
    const std::size_t neighbour = end - i > 2 ? 1 : 0;
    for (std::size_t k = i + neighbour; k + neighbour < end; ++k) {
      spikes.push_back(axis);
      spikes.back().sample = k, spikes.back().time = imu.samples[k].time, spikes.back().jump = differences[k];
    }
    i = end;
  }
}

/// Returns the number of readings, each of which may jump on several axes. `spikes`: in the order of time.
std::size_t countReadings(const std::vector<ImuSpike>& spikes) {
  std::size_t count = spikes.empty() ? 0 : 1;
  for (std::size_t k = 1; k < spikes.size(); ++k) count += spikes[k].sample != spikes[k - 1].sample ? 1 : 0;
  return count;
}

/// The readings of an axis, and their usual difference from the reading before.
struct AxisReadings {
  std::vector<double> values;
  double usual = 0;
  bool repeats = false;  ///< often, as values of a coarse sensor at rest do

  explicit AxisReadings(std::vector<double> readings) : values(std::move(readings)) {
    constexpr double often = 0.02;
    std::vector<double> differences;
    std::size_t equal = 0, in_a_row = 0;
    for (std::size_t i = 1; i < values.size(); ++i) {
      in_a_row = values[i] == values[i - 1] ? in_a_row + 1 : 0;
      if (in_a_row == 0) differences.push_back(std::abs(values[i] - values[i - 1]));
      if (in_a_row == 1) ++equal;
    }
    repeats = double(equal) > often * double(differences.size());
    usual = medianOf(std::move(differences));
  }

  /// Returns whether these readings change as in motion.
  bool moveBetween(std::size_t first, std::size_t end) const {
    constexpr double far_apart = 10;  // times the usual difference
    const auto [least, most] =
        std::minmax_element(values.begin() + std::ptrdiff_t(first), values.begin() + std::ptrdiff_t(end));
    return *most - *least > far_apart * usual;
  }
};

/// Adds the times in which an axis hangs, from the second equal value on. If the sensor moves meanwhile, the axis goes on
/// from anywhere; otherwise only a step tells a hanging sensor from a coarse one at rest.
void addStuck(const std::vector<AxisReadings>& axes, const AxisReadings& axis, const ImuStream& imu,
              std::vector<GrossReadings>& stuck) {
  constexpr std::size_t least_readings = 20;
  constexpr double least_time = 0.2;              // s
  constexpr double far_away = 5, anywhere = 0.5;  // times the usual difference of successive readings
  const std::vector<double>& values = axis.values;
  double largest = 0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  for (std::size_t i = 0, end = 0; i < values.size(); i = end) {
    for (end = i + 1; end < values.size() && values[end] == values[i];) ++end;
    const double from = imu.samples[i].time, to = imu.samples[end - 1].time;
    if (end - i < least_readings || to - from < least_time || std::abs(values[i]) == largest) continue;
    const double before = i > 0 ? std::abs(values[i] - values[i - 1]) : 0,
                 behind = end < values.size() ? std::abs(values[end] - values[i]) : 0;
    const bool moves = !axis.repeats && std::any_of(axes.begin(), axes.end(), [&](const AxisReadings& one) {
      return one.moveBetween(i, end);
    });
    if (std::max(before, behind) > (moves ? anywhere : far_away) * axis.usual)
      stuck.push_back({imu.samples[before > far_away * axis.usual ? i : i + 1].time, to, unknown});
  }
}

}  // namespace

std::vector<GrossReadings> stuckReadings(const ImuStream& imu) {
  std::vector<GrossReadings> all, joined;
  std::vector<AxisReadings> axes;
  for (int axis = 0; axis < 6; ++axis) axes.emplace_back(axisOf(imu, axis));
  for (const AxisReadings& axis : axes) addStuck(axes, axis, imu, all);
  std::sort(all.begin(), all.end(),
            [](const GrossReadings& a, const GrossReadings& b) { return a.from < b.from; });
  for (const GrossReadings& one : all) {
    if (joined.empty() || one.from > joined.back().to)
      joined.push_back(one);
    else
      joined.back().to = std::max(joined.back().to, one.to);
  }
  return joined;
}

std::string noteOnStuck(const std::vector<GrossReadings>& stuck, const ImuStream& imu) {
  if (stuck.empty()) return {};
  std::vector<std::string> named;
  for (const GrossReadings& one : stuck)
    named.push_back(fmt::format("from {:.3f} to {:.3f} s", one.from - imu.samples.front().time,
                                one.to - imu.samples.front().time));
  return fmt::format(
      "{}: readings stay exactly the same {} after the first reading, as of a sensor that hangs. They were left out; "
      "--robust none keeps them.",
      nameOf(imu), fmt::join(named, ", "));
}

Spikes spikesOf(const ImuStream& imu) {
  Spikes found;
  std::vector<ImuSpike>& spikes = found.all;
  if (imu.samples.size() < fewest) return found;
  const std::vector<bool> has_neighbours = neighboursOf(imu);
  for (int axis = 0; axis < 6; ++axis) {
    addSpikes(axisOf(imu, axis), has_neighbours, {.is_gyro = axis < 3, .axis = axis % 3}, imu, spikes);
  }
  std::stable_sort(spikes.begin(), spikes.end(),
                   [](const ImuSpike& a, const ImuSpike& b) { return a.sample < b.sample; });
  if (const std::size_t readings = countReadings(spikes); 100 * readings > imu.samples.size())
    found = {{}, readings};
  return found;
}

ImuStream withoutSpikes(ImuStream imu, const std::vector<ImuSpike>& spikes) {
  std::vector<ImuSample> kept;
  auto spike = spikes.begin();
  for (std::size_t i = 0; i < imu.samples.size(); ++i) {
    if (spike == spikes.end() || spike->sample != i) kept.push_back(imu.samples[i]);
    while (spike != spikes.end() && spike->sample == i) ++spike;
  }
  imu.samples = std::move(kept);
  return imu;
}

std::string noteOn(const Spikes& found, const ImuStream& imu) {
  const std::vector<ImuSpike>& spikes = found.all;
  if (found.kept > 0)
    return fmt::format(
        "{}: {} of {} readings jump off the readings around. So many may be knocks of the rig and were kept: if it "
        "was not knocked, check the sensor and its transfer.",
        nameOf(imu), found.kept, imu.samples.size());
  if (spikes.empty()) return {};
  constexpr std::size_t most_named = 4;
  const std::size_t readings = countReadings(spikes);
  std::vector<std::string> named;
  for (std::size_t k = 0; k < spikes.size() && named.size() < most_named; ++k) {
    const ImuSpike& s = spikes[k];
    if (k > 0 && s.sample == spikes[k - 1].sample) continue;
    named.push_back(fmt::format("{} {} by {:.2g} {} {:.3f} s after the first reading",
                                s.is_gyro ? "gyroscope" : "accelerometer", "xyz"[s.axis], s.jump,
                                s.is_gyro ? "rad/s" : "m/s^2", s.time - imu.samples.front().time));
  }
  if (readings > named.size()) named.push_back(fmt::format("{} more", readings - named.size()));
  return fmt::format(
      "{}: {} jump{} off the readings around, as no motion does: {}. Readings that jump were left out; --robust none "
      "keeps them.",
      nameOf(imu), readings == 1 ? "one reading" : fmt::format("{} readings", readings),
      readings == 1 ? "s" : "", fmt::join(named, ", "));
}

}  // namespace slom::calibration
