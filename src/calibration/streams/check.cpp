#include "calibration/streams/check.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibration/median.hpp"
#include "calibration/streams/doubt.hpp"
#include "slom/calibration/error.hpp"

namespace slom::calibration {
namespace {

constexpr double gravity_m_s2 = 9.81;

/// Magnitudes of the readings of one sensor: their median, and the median distance from it.
struct Magnitudes {
  double median = 0, spread = 0;
  /// Takes the magnitudes of all readings.
  template <class Value>
  Magnitudes(const ImuStream& imu, const Value& value) {
    std::vector<double> all;
    for (const ImuSample& sample : imu.samples) all.push_back(value(sample).norm());
    median = medianOf(all);
    for (double& one : all) one = std::abs(one - median);
    spread = medianOf(std::move(all));
  }
};

/// Refuses specific forces in place of angular velocities: their magnitude is that of gravity, and varies much less than
/// that of angular velocities does.
void requireRatesFirst(const ImuStream& imu) {
  constexpr double near = 1.2, steadier = 3;
  const Magnitudes first(imu, [](const ImuSample& s) { return s.gyro; }),
      last(imu, [](const ImuSample& s) { return s.force; });
  if (!(first.median > gravity_m_s2 / near && first.median < gravity_m_s2 * near)) return;
  if (!(steadier * first.spread / first.median < last.spread / last.median)) return;
  badStream(
      imu,
      fmt::format("the first three readings have a magnitude of {:.3g} in the median, that of gravity, as if "
                  "accelerometer and gyroscope were exchanged",
                  first.median),
      "give the angular velocities first, and the specific forces after them");
}

/// Refuses forces in units of gravity or thousandths of it: their median magnitude is then far from 9.8.
void requireForcesInUnits(const ImuStream& imu) {
  constexpr double spread = 1.5;
  const double median = Magnitudes(imu, [](const ImuSample& s) { return s.force; }).median;
  const auto isNear = [&](double value) { return median > value / spread && median < value * spread; };
  if (isNear(gravity_m_s2)) return;
  const std::string fault =
      fmt::format("the specific forces have a magnitude of {:.3g} in the median", median);
  if (isNear(1)) badStream(imu, fault + ", as if they were in units of gravity", "multiply them by 9.80665");
  if (isNear(1000))
    badStream(imu, fault + ", as if they were in thousandths of gravity", "multiply them by 0.00980665");
  badStream(imu, fault + " instead of about 9.8 m/s^2",
            "give specific forces in m/s^2 in the last three columns, with gravity in them");
}

/// Returns the number of readings of an axis that equal its largest magnitude, in runs of three or more.
template <class Value>
std::size_t saturated(const ImuStream& imu, const Value& value) {
  double largest = 0;
  for (const ImuSample& sample : imu.samples) largest = std::max(largest, std::abs(value(sample)));
  constexpr std::size_t shortest = 3;
  std::size_t run = 0, all = 0;
  for (const ImuSample& sample : imu.samples) {
    run = std::abs(value(sample)) == largest ? run + 1 : 0;
    all += run == shortest ? shortest : run > shortest ? 1 : 0;
  }
  return largest > 0 ? all : 0;
}

}  // namespace

std::string nameOf(const ImuStream& imu) { return imu.file.empty() ? imu.name : imu.file; }

void badStream(const ImuStream& imu, const std::string& fault, const std::string& remedy) {
  throw DataError("slom.calibration.bad-stream", {.place = nameOf(imu), .fault = fault, .remedy = remedy});
}

void requireTime(const CameraData& camera, const View& view) {
  if (view.time_ns) return;
  throw DataError(
      "slom.calibration.bad-stream",
      {.place = nameOf(camera),
       .fault = fmt::format("image {} has no time", view.image),
       .remedy = "give corner files with a column t_ns, or photographs whose names are times in ns"});
}

void requireGoodStream(const ImuStream& imu) {
  if (imu.samples.size() < 2) badStream(imu, "there are fewer than two readings", "give a recording");
  for (std::size_t i = 0; i < imu.samples.size(); ++i) {
    const ImuSample& sample = imu.samples[i];
    if (!std::isfinite(sample.time) || !sample.gyro.allFinite() || !sample.force.allFinite())
      badStream(imu, fmt::format("samples[{}] is not finite", i), "leave it out");
    if (i > 0 && !(sample.time > imu.samples[i - 1].time))
      badStream(imu, fmt::format("samples[{}] is at {:.6f} s, not after the one before", i, sample.time),
                "sort the samples by time, and keep one of each time");
  }
  if (imu.noise) {
    for (const auto& [what, density] : {std::pair("gyro", imu.noise->gyro),
                                        {"force", imu.noise->force},
                                        {"gyro_walk", imu.noise->gyro_walk},
                                        {"force_walk", imu.noise->force_walk}}) {
      if (!(density > 0 && std::isfinite(density)))
        badStream(imu, fmt::format("the density ImuNoise::{} is {}", what, density),
                  "give a positive number");
    }
  }
  requireRatesFirst(imu);
  requireForcesInUnits(imu);
}

std::vector<std::pair<double, double>> gapsOf(const ImuStream& imu) {
  constexpr double usual_intervals = 5;
  std::vector<double> intervals;
  for (std::size_t i = 1; i < imu.samples.size(); ++i)
    intervals.push_back(imu.samples[i].time - imu.samples[i - 1].time);
  const double longest = usual_intervals * medianOf(intervals);
  std::vector<std::pair<double, double>> gaps;
  for (std::size_t i = 1; i < imu.samples.size(); ++i) {
    if (imu.samples[i].time - imu.samples[i - 1].time > longest)
      gaps.emplace_back(imu.samples[i - 1].time, imu.samples[i].time);
  }
  return gaps;
}

void noteFaults(const ImuStream& imu, StreamResult& result) {
  const auto gaps = gapsOf(imu);
  if (!gaps.empty()) {
    const auto longest = *std::max_element(gaps.begin(), gaps.end(), [](const auto& a, const auto& b) {
      return a.second - a.first < b.second - b.first;
    });
    result.notes.push_back(fmt::format(
        "{}: readings are missing {}, for up to {:.3g} s, {:.3f} s after the first reading; pairs of images around the "
        "gap are not used.",
        nameOf(imu), gaps.size() == 1 ? "once" : fmt::format("{} times", gaps.size()),
        longest.second - longest.first, longest.first));
  }
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t gyro = saturated(imu, [&](const ImuSample& s) { return s.gyro[axis]; });
    const std::size_t force = saturated(imu, [&](const ImuSample& s) { return s.force[axis]; });
    for (const auto& [count, what] : {std::pair(gyro, "gyroscope"), {force, "accelerometer"}}) {
      if (count > 0)
        addDoubt(
            fmt::format(
                "{} readings of the {}'s {} axis in {} stay at its largest magnitude, as if the sensor were saturated",
                count, what, "xyz"[axis], nameOf(imu)),
            "use a larger range, or move less quickly.", result);
    }
  }
}

bool isSaturated(const ImuStream& imu) {
  for (int axis = 0; axis < 3; ++axis) {
    if (saturated(imu, [&](const ImuSample& s) { return s.gyro[axis]; }) > 0 ||
        saturated(imu, [&](const ImuSample& s) { return s.force[axis]; }) > 0)
      return true;
  }
  return false;
}

}  // namespace slom::calibration
