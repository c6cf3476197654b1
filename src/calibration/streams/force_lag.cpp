#include "calibration/streams/force_lag.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calibration/median.hpp"
#include "calibration/streams/check.hpp"
#include "calibration/streams/doubt.hpp"
#include "calibration/streams/held_axes.hpp"
#include "slom/calibration/error.hpp"
#include "slom/calibration/number_text.hpp"

namespace slom::calibration {
namespace {

/// Stated standard deviations of a lag that is no chance. Errors that images share make them too small.
constexpr double significant_lag = 10;

/// Returns the readings with the forces that were read `lag` later: those of the same motion if the accelerometer lags.
ImuStream withForcesFrom(const ImuStream& imu, double lag) {
  const std::vector<ImuSample>& given = imu.samples;
  ImuStream shifted = imu;
  std::size_t next = 1;
  for (ImuSample& sample : shifted.samples) {
    const double time = sample.time + lag;
    while (next + 1 < given.size() && given[next].time < time) ++next;
    const ImuSample &a = given[next - 1], &b = given[next];
    const double along = std::clamp((time - a.time) / (b.time - a.time), 0.0, 1.0);
    sample.force = vec3(a.force + along * (b.force - a.force));
  }
  return shifted;
}

double usualSpacing(const ImuStream& imu) {
  std::vector<double> spacings;
  for (std::size_t i = 1; i < imu.samples.size(); ++i)
    spacings.push_back(imu.samples[i].time - imu.samples[i - 1].time);
  return medianOf(std::move(spacings));
}

/// Returns the minimum [s] of the parabola through the RSS of fits with a lag of -step, 0 and step, and its standard deviation;
/// nothing if there is no minimum.
std::optional<StreamNumber> minimumOf(double before, double at, double after, double step) {
  const double curvature = (before + after - 2 * at) / (step * step);
  if (!(curvature > 0)) return std::nullopt;
  return StreamNumber{(before - after) / (2 * step * curvature), std::sqrt(2 / curvature)};
}

/// Returns the clause on a lag.
std::string clauseOn(const StreamNumber& lag, const std::string& imu) {
  const char *late = "accelerometer", *early = "gyroscope";
  if (lag.value < 0) std::swap(late, early);
  return fmt::format("the {} of {} seems to lag behind its {} by {} +- {} ms", late, imu, early,
                     twoDigits(1e3 * std::abs(lag.value)), twoDigits(1e3 * lag.std));
}

}  // namespace

bool doubtForceLag(const Dataset& data, const Settings& settings, const CamerasAt& cameras,
                   const std::vector<RigAtImage>& images, const std::vector<StartedImu>& imus, double gravity,
                   const Options& options, StreamResult& result) {
  if (!result.success()) return false;
  bool is_found = false;
  Settings at = settings;
  at.sigma_px = result.sigma_px;
  const CondensedCorners corners = condensed(data, cameras);
  const std::vector<StartedImu> started = startedAt(result, imus);
  for (std::size_t i = 0; i < imus.size(); ++i) {
    if (isSaturated(*imus[i].stream)) continue;
    ImuStream shifted;
    double ratio = 1;  // residuals of the last fit, relative to what the noise predicts
    /// Returns the RSS of a fit without this lag; infinite if there is none.
    const auto fit = [&](double lag) {
      std::vector<StartedImu> with_lag = started;
      shifted = withForcesFrom(*imus[i].stream, lag);
      with_lag[i].stream = &shifted;
      StreamProblem problem(data, corners, at, cameras, images, mtk::S2<>(vec3(-result.gravity)), with_lag,
                            gravity);
      const Summary summary = problem.optimize(options);
      const ImuStreamResult without = problem.posesAndRatios()[i];
      ratio = std::max({1.0, without.gyro_ratio, without.force_ratio});
      return summary.converged ? summary.final_rss : INFINITY;
    };
    try {
      const double step = usualSpacing(*imus[i].stream), none = fit(0);
      auto lag = minimumOf(fit(-step), none, fit(step), step);
      if (!lag || !(fit(lag->value) < none)) continue;
      lag->std *= ratio;
      if (std::abs(lag->value) < significant_lag * lag->std) continue;
      result.imus[i].force_lag = lag;
      addDoubt(
          clauseOn(*lag, result.imus[i].name),
          "shift the columns of one sensor in time, so that a row has readings of both at one time. Filters may delay them "
          "by different times.",
          result);
      is_found = true;
    } catch (const slom::Error&) {
      continue;  // the result as it is stands
    }
  }
  return is_found;
}

}  // namespace slom::calibration
