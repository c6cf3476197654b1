#include "calibration/streams/force_lag.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calibration/limits.hpp"
#include "calibration/median.hpp"
#include "calibration/streams/check.hpp"
#include "calibration/streams/doubt.hpp"
#include "slom/calibration/error.hpp"
#include "slom/calibration/number_text.hpp"

namespace slom::calibration {
namespace {

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

/// The fits of one IMU's readings without a lag.
class LagFits {
 public:
  LagFits(const Dataset& data, const Settings& settings, const CamerasAt& cameras,
          const std::vector<RigAtImage>& images, const mtk::S2<>& up, const std::vector<StartedImu>& imus,
          double gravity, const Options& options, double least_deviations)
      : data_(data),
        corners_(condensed(data, cameras)),
        settings_(settings),
        cameras_(cameras),
        images_(images),
        up_(up),
        imus_(imus),
        gravity_(gravity),
        options_(options),
        least_deviations_(least_deviations) {}

  /// The RSS of a fit; infinite if there is none. How large residuals are, relative to what the noise predicts, at least 1.
  struct Fit {
    double rss = INFINITY, ratio = 1;
  };

  bool isSignificant(const StreamNumber& lag, const Fit& fit) const {
    return std::abs(lag.value) >= least_deviations_ * fit.ratio * lag.std;
  }

  Fit without(double lag, std::size_t imu) const {
    std::vector<StartedImu> with_lag = imus_;
    ImuStream shifted = *imus_[imu].stream;
    removeLag(lag, shifted);
    with_lag[imu].stream = &shifted;
    StreamProblem problem(data_, corners_, settings_, cameras_, images_, up_, with_lag, gravity_);
    const Summary summary = problem.optimize(options_);
    if (!summary.converged) return {};
    const ImuStreamResult one = problem.posesAndRatios()[imu];
    return {summary.final_rss, std::max({1.0, one.gyro_ratio, one.force_ratio})};
  }

  /// Returns the lag if it is significant. A long lag is sought again around the one that was found.
  std::optional<StreamNumber> lagOf(std::size_t imu) const {
    constexpr int most_rounds = 4;
    if (isSaturated(*imus_[imu].stream)) return {};
    const double step = usualSpacing(*imus_[imu].stream), none = without(0, imu).rss;
    StreamNumber lag{0};
    Fit best{none};
    for (int round = 0; round < most_rounds; ++round) {
      const auto next =
          minimumOf(without(lag.value - step, imu).rss, best.rss, without(lag.value + step, imu).rss, step);
      if (!next) return {};
      lag = {lag.value + next->value, next->std};
      best = without(lag.value, imu);
      if (std::abs(next->value) < step || !isSignificant(lag, best)) break;
    }
    if (least_deviations_ > 0 && !(best.rss < none && isSignificant(lag, best))) return {};
    lag.std *= best.ratio;
    return lag;
  }

 private:
  const Dataset& data_;
  CondensedCorners corners_;
  const Settings& settings_;
  const CamerasAt& cameras_;
  const std::vector<RigAtImage>& images_;
  const mtk::S2<>& up_;
  const std::vector<StartedImu>& imus_;
  double gravity_;
  const Options& options_;
  double least_deviations_;
};

/// Returns the clause on a lag.
std::string clauseOn(const StreamNumber& lag, const std::string& imu) {
  const char *late = "accelerometer", *early = "gyroscope";
  if (lag.value < 0) std::swap(late, early);
  const ValueText text = withStd(1e3 * std::abs(lag.value), 1e3 * lag.std);
  return fmt::format("the {} of {} lags behind its {} by {} +- {} ms", late, imu, early, text.value,
                     text.std);
}

}  // namespace

ForceLags findForceLags(const Dataset& data, const Settings& settings, const CamerasAt& cameras,
                        const std::vector<RigAtImage>& images, const mtk::S2<>& up,
                        const std::vector<StartedImu>& imus, double gravity, const Options& options,
                        double least_deviations) {
  ForceLags lags(imus.size());
  if (!reasonToEnd(settings.limits).empty()) return lags;
  const LagFits fits(data, settings, cameras, images, up, imus, gravity, options, least_deviations);
  for (std::size_t i = 0; i < imus.size(); ++i) {
    try {
      lags[i] = fits.lagOf(i);
    } catch (const slom::Error&) {
      continue;  // which the fit itself says
    }
  }
  return lags;
}

void removeLag(double lag, ImuStream& imu) {
  const std::vector<ImuSample> given = imu.samples;
  std::size_t next = 1;
  for (ImuSample& sample : imu.samples) {
    const double time = sample.time + lag;
    while (next + 1 < given.size() && given[next].time < time) ++next;
    const ImuSample &a = given[next - 1], &b = given[next];
    const double along = std::clamp((time - a.time) / (b.time - a.time), 0.0, 1.0);
    sample.force = vec3(a.force + along * (b.force - a.force));
  }
}

void reportLags(const ForceLags& lags, StreamResult& result) {
  for (std::size_t i = 0; i < lags.size(); ++i) {
    if (!lags[i]) continue;
    result.imus[i].force_lag = lags[i];
    addDoubt(
        clauseOn(*lags[i], result.imus[i].name),
        "the fit reads the forces at the times of the angular velocities, so the time offset is the gyroscope's. For "
        "other programs, shift the columns of one sensor in time. A cause is a filter that delays one sensor more than the "
        "other.",
        result);
  }
}

}  // namespace slom::calibration
