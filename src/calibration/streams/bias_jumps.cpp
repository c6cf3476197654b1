#include "calibration/streams/bias_jumps.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibration/median.hpp"
#include "calibration/streams/check.hpp"
#include "calibration/streams/gross_readings.hpp"
#include "calibration/streams/joint_fit.hpp"
#include "slom/calibration/error.hpp"

namespace slom::calibration {
namespace {

constexpr double window = 1;                  ///< over which biases are averaged on both sides of a step [s]
constexpr double stay = 3, least_stay = 1.5;  ///< over which it must last, also near the ends [s]
constexpr double looser = 1000;               ///< times the usual walk
/// Least size of a step that may be a jump, in usual steps. A jump also enlarges the steps beside it.
constexpr double likely = 5;
/// Least size of a jump, in usual steps of a fit without it. Images that share errors look like steps of the forces in the
/// first place.
constexpr double least_turns = 5, least_pushes = 10;
constexpr double least_of_walk = 100;  ///< times the step of a walk over the window
constexpr std::size_t most_jumps = 4;  ///< of one sensor
constexpr double margin = 2.5;         ///< intervals whose readings are left out, on both sides of a jump

/// A bias over time, by intervals between images.
struct BiasSeries {
  std::vector<double> times;  ///< of the middles of the intervals, in the clock of the IMU [s]
  std::vector<Eigen::Vector3d> values;
  double interval = 0;  ///< usual one [s]
};

BiasSeries seriesOf(const std::map<std::size_t, vec3>& by_image, const std::vector<RigAtImage>& images,
                    double offset) {
  BiasSeries series;
  std::vector<double> intervals;
  for (const auto& [i, bias] : by_image) {
    series.times.push_back((images[i].time + images[i + 1].time) / 2 + offset);
    series.values.push_back(bias);
    intervals.push_back(images[i + 1].time - images[i].time);
  }
  series.interval = medianOf(intervals);
  return series;
}

/// The change of a bias from one side of interval k to the other.
struct BiasStep {
  std::size_t k = 0;
  Eigen::Vector3d change = Eigen::Vector3d::Zero();
};

constexpr std::size_t blurred = 2;  ///< intervals around a jump whose biases are between

std::size_t countOf(const BiasSeries& series, double time) {
  return std::size_t(std::max(3., std::ceil(time / series.interval)));
}

/// Returns the steps of the mean at all intervals with a window on both sides, the largest first.
std::vector<BiasStep> stepsOf(const BiasSeries& series) {
  const std::size_t half = countOf(series, window), end = half + blurred;
  std::vector<BiasStep> steps;
  for (std::size_t k = end; k + end < series.values.size(); ++k) {
    BiasStep step{k};
    for (std::size_t i = blurred; i < half + blurred; ++i)
      step.change += (series.values[k + i] - series.values[k - i]) / double(half);
    steps.push_back(step);
  }
  std::sort(steps.begin(), steps.end(),
            [](const BiasStep& a, const BiasStep& b) { return a.change.norm() > b.change.norm(); });
  return steps;
}

/// Returns whether medians over longer times differ by the step, too. They do not if the images are wrong for a second. False
/// near the ends.
bool stays(const BiasSeries& series, const BiasStep& step) {
  constexpr double most_difference = 0.3;
  const std::size_t most = countOf(series, stay), least = countOf(series, least_stay) + blurred;
  if (step.k < least || step.k + least >= series.values.size()) return false;
  Eigen::Vector3d change;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> before, behind;
    for (std::size_t i = blurred; i < most + blurred; ++i) {
      if (i <= step.k) before.push_back(series.values[step.k - i][axis]);
      if (step.k + i < series.values.size()) behind.push_back(series.values[step.k + i][axis]);
    }
    change[axis] = medianOf(behind) - medianOf(before);
  }
  return (change - step.change).norm() < most_difference * step.change.norm();
}

/// Returns the median of sizes of steps; infinite if there are none.
double usualOf(std::vector<double> sizes) { return sizes.empty() ? INFINITY : medianOf(std::move(sizes)); }

/// Returns the usual size of the other steps, whose windows a jump at k does not touch.
double usualStepBeside(const BiasSeries& series, const std::vector<BiasStep>& steps, std::size_t k) {
  const std::size_t touched = countOf(series, window) + 2 * blurred;
  std::vector<double> sizes;
  for (const BiasStep& step : steps) {
    if (step.k + touched < k || step.k > k + touched) sizes.push_back(step.change.norm());
  }
  return usualOf(std::move(sizes));
}

/// Returns the largest step that is likely to be a jump, and subtracts it from the values behind.
std::optional<BiasJump> takeJump(BiasSeries& series, bool is_gyro, double density) {
  const std::vector<BiasStep> steps = stepsOf(series);
  const auto found =
      std::find_if(steps.begin(), steps.end(), [&](const BiasStep& step) { return stays(series, step); });
  if (found == steps.end()) return {};
  const double usual = usualStepBeside(series, steps, found->k);
  const double least = std::max(likely * usual, least_of_walk * density * std::sqrt(window));
  if (found->change.norm() < least) return {};
  for (std::size_t i = found->k; i < series.values.size(); ++i) series.values[i] -= found->change;
  return BiasJump{is_gyro, series.times[found->k], vec3(found->change), margin * series.interval};
}

std::vector<BiasJump> likelyJumps(BiasSeries series, bool is_gyro, double density) {
  std::vector<BiasJump> jumps;
  while (jumps.size() <= most_jumps) {
    const auto jump = takeJump(series, is_gyro, density);
    if (!jump) return jumps;
    jumps.push_back(*jump);
  }
  return {};  // a bias that changes all the time
}

/// The biases of an IMU.
struct Biases {
  BiasSeries gyro, force;
};

/// Returns the least size of a jump, from biases of a fit without it.
double leastJump(const BiasSeries& series, bool is_gyro) {
  std::vector<double> sizes;
  for (const BiasStep& step : stepsOf(series)) sizes.push_back(step.change.norm());
  return (is_gyro ? least_turns : least_pushes) * usualOf(std::move(sizes));
}

/// Removes the jump that falls short most of its least size in a fit without the jumps. Returns whether there is one.
bool removeSmallest(const std::vector<Biases>& without, std::vector<std::vector<BiasJump>>& jumps) {
  double smallest = 1;
  std::optional<std::pair<std::size_t, std::size_t>> found;
  for (std::size_t i = 0; i < jumps.size(); ++i) {
    const double least_turn = leastJump(without[i].gyro, true),
                 least_push = leastJump(without[i].force, false);
    for (std::size_t k = 0; k < jumps[i].size(); ++k) {
      const double ratio = jumps[i][k].change.norm() / (jumps[i][k].is_gyro ? least_turn : least_push);
      if (ratio < smallest) smallest = ratio, found = {i, k};
    }
  }
  if (found) jumps[found->first].erase(jumps[found->first].begin() + std::ptrdiff_t(found->second));
  return found.has_value();
}

}  // namespace

std::vector<std::vector<BiasJump>> findBiasJumps(const Dataset& data, const Settings& settings,
                                                 const CamerasAt& cameras,
                                                 const std::vector<RigAtImage>& images, const mtk::S2<>& up,
                                                 const std::vector<StartedImu>& imus, double gravity) {
  constexpr int few_iterations = 20;
  Options options = optionsOfStreams(settings);
  options.deviation_tolerance = 1;
  options.max_iterations = std::min(options.max_iterations, few_iterations);
  std::optional<CondensedCorners> corners;
  /// Returns the biases over time, if they walk nearly freely, of readings without these jumps.
  const auto biasesWithout = [&](const std::vector<std::vector<BiasJump>>& removed) {
    std::vector<StartedImu> loose = imus;
    std::vector<ImuStream> streams(imus.size());
    for (std::size_t i = 0; i < imus.size(); ++i) {
      streams[i] = *imus[i].stream;
      removeJumps(removed[i], streams[i]);
      loose[i].stream = &streams[i];
      loose[i].noise.gyro_walk *= looser;
      loose[i].noise.force_walk *= looser;
    }
    StreamProblem problem(data, *corners, settings, cameras, images, up, loose, gravity, Cauchy(gross_scale));
    problem.optimize(options);
    std::vector<Biases> all;
    for (const StartedImu& imu : problem.started())
      all.push_back({seriesOf(imu.gyro_biases, images, imu.start.offset),
                     seriesOf(imu.force_biases, images, imu.start.offset)});
    return all;
  };

  std::vector<std::vector<BiasJump>> jumps(imus.size());
  const auto is_any_left = [&] {
    return std::any_of(jumps.begin(), jumps.end(), [](const auto& one) { return !one.empty(); });
  };
  try {
    corners = condensed(data, cameras);
    const std::vector<Biases> with = biasesWithout(jumps);
    for (std::size_t i = 0; i < imus.size(); ++i) {
      jumps[i] = likelyJumps(with[i].gyro, true, imus[i].noise.gyro_walk);
      const auto of_force = likelyJumps(with[i].force, false, imus[i].noise.force_walk);
      jumps[i].insert(jumps[i].end(), of_force.begin(), of_force.end());
      std::sort(jumps[i].begin(), jumps[i].end(),
                [](const BiasJump& a, const BiasJump& b) { return a.time < b.time; });
    }
    while (is_any_left() && removeSmallest(biasesWithout(jumps), jumps)) {
    }
  } catch (const slom::Error&) {  // which the fit itself says
    return std::vector<std::vector<BiasJump>>(imus.size());
  }
  return jumps;
}

void removeJumps(const std::vector<BiasJump>& jumps, ImuStream& imu) {
  for (const BiasJump& jump : jumps) {
    for (ImuSample& sample : imu.samples) {
      if (sample.time < jump.time) continue;
      vec3& reading = jump.is_gyro ? sample.gyro : sample.force;
      reading = vec3(reading - jump.change);
    }
  }
  std::erase_if(imu.samples, [&](const ImuSample& sample) {
    return std::any_of(jumps.begin(), jumps.end(),
                       [&](const BiasJump& jump) { return std::abs(sample.time - jump.time) < jump.margin; });
  });
}

double incrementDeviation(const std::vector<BiasJump>& jumps, bool is_gyro, double density, double from,
                          double to) {
  double variance = density * density * (to - from);
  for (const BiasJump& jump : jumps) {
    if (jump.is_gyro == is_gyro && jump.time >= from && jump.time < to) variance += jump.change.squaredNorm();
  }
  return std::sqrt(variance);
}

double firstJump(const std::vector<BiasJump>& jumps, bool is_gyro) {
  const auto first =
      std::find_if(jumps.begin(), jumps.end(), [&](const BiasJump& jump) { return jump.is_gyro == is_gyro; });
  return first == jumps.end() ? INFINITY : first->time;
}

std::string noteOn(const std::vector<BiasJump>& jumps, const ImuStream& imu) {
  if (jumps.empty()) return {};
  std::vector<std::string> named;
  for (const BiasJump& jump : jumps)
    named.push_back(fmt::format("that of the {} by ({:.2g}, {:.2g}, {:.2g}) {} at {:.2f} s",
                                jump.is_gyro ? "gyroscope" : "accelerometer", jump.change[0], jump.change[1],
                                jump.change[2], jump.is_gyro ? "rad/s" : "m/s^2",
                                jump.time - imu.samples.front().time));
  return fmt::format(
      "{}: biases jump and stay, {} after the first reading. The fit subtracts this from later readings, so biases "
      "are those before the first; --robust none keeps the readings.",
      nameOf(imu), fmt::join(named, ", "));
}

}  // namespace slom::calibration
