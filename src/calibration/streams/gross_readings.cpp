#include "calibration/streams/gross_readings.hpp"

#include <algorithm>
#include <cstddef>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibration/streams/check.hpp"
#include "calibration/streams/joint_fit.hpp"

namespace slom::calibration {
namespace {

/// Returns the times with those near each other as one.
std::vector<GrossReadings> joined(const std::vector<GrossReadings>& gross) {
  std::vector<GrossReadings> times;
  for (const GrossReadings& one : gross) {
    if (times.empty() || one.from > times.back().to + 2.5 * (one.to - one.from))
      times.push_back(one);
    else
      times.back().to = one.to;
  }
  return times;
}

}  // namespace

std::vector<std::vector<GrossReadings>> findGrossReadings(const Dataset& data, const Settings& settings,
                                                          const CamerasAt& cameras,
                                                          const std::vector<RigAtImage>& images,
                                                          const mtk::S2<>& up,
                                                          const std::vector<StartedImu>& imus,
                                                          double gravity) {
  constexpr int few_iterations = 20;
  Options options = optionsOfStreams(settings);
  options.deviation_tolerance = 1;
  options.max_iterations = std::min(options.max_iterations, few_iterations);
  try {
    StreamProblem problem(data, condensed(data, cameras), settings, cameras, images, up, imus, gravity,
                          Cauchy(gross_scale));
    problem.optimize(options);
    return problem.grossReadings();
  } catch (const slom::Error&) {  // which the fit without the loss says
    return std::vector<std::vector<GrossReadings>>(imus.size());
  }
}

void removeReadings(const std::vector<GrossReadings>& gross, ImuStream& imu) {
  std::erase_if(imu.samples, [&](const ImuSample& sample) {
    return std::any_of(gross.begin(), gross.end(), [&](const GrossReadings& one) {
      return sample.time >= one.from && sample.time <= one.to;
    });
  });
}

std::string noteOn(const std::vector<GrossReadings>& gross, const ImuStream& imu) {
  if (gross.empty()) return {};
  constexpr std::size_t most_named = 4;
  const std::vector<GrossReadings> times = joined(gross);
  std::vector<std::string> named;
  for (std::size_t k = 0; k < std::min(times.size(), most_named); ++k)
    named.push_back(fmt::format("from {:.3f} to {:.3f} s", times[k].from - imu.samples.front().time,
                                times[k].to - imu.samples.front().time));
  if (times.size() > most_named) named.push_back(fmt::format("{} more times", times.size() - most_named));
  const auto worst =
      std::max_element(gross.begin(), gross.end(),
                       [](const GrossReadings& a, const GrossReadings& b) { return a.times < b.times; });
  return fmt::format(
      "{}: between {} of images, readings contradict the images, by up to {:.2g} times the usual residual: {} after "
      "the first reading. These readings were left out; --robust none keeps them.",
      nameOf(imu), gross.size() == 1 ? "one pair" : fmt::format("{} pairs", gross.size()), worst->times,
      fmt::join(named, ", "));
}

}  // namespace slom::calibration
