#include "calibration/streams/preparation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calibration/limits.hpp"
#include "calibration/streams/joint_fit.hpp"
#include "slom/calibration/error.hpp"

namespace slom::calibration {
namespace {

/// Rounds of fits in which the noise of corners and readings is estimated in turn with the values, and the relative
/// change of a standard deviation at which they end.
constexpr int most_noise_rounds = 20;
constexpr double least_change = 0.02;

/// Rounds in which corners are linearised again at the values of the fit before.
constexpr int most_linearizations = 10;

double changeOf(const ImuNoise& before, const ImuNoise& after) {
  return std::max(std::abs(std::log(before.gyro / after.gyro)),
                  std::abs(std::log(before.force / after.force)));
}

/// Estimates the noise of corners and readings in turn with the values, until it stays the same; the corners are linearised
/// once. Corners are at least as noisy as the cameras' own fit found them. Returns the number of rounds. If a fit fails,
/// the start stays as it is.
int estimateNoise(const Dataset& data, const std::vector<RigAtImage>& images, Options options, double gravity,
                  double least_px, StreamStart& start) {
  const CondensedCorners corners = condensed(data, start.cameras);
  options.deviation_tolerance = 0.1;
  for (int round = 1; reasonToEnd(start.settings.limits).empty(); ++round) {
    StreamProblem problem(data, corners, start.settings, start.cameras, images, start.up, start.imus,
                          gravity);
    if (!problem.optimize(options).converged) return round;
    const double sigma_px = std::max(least_px, start.settings.sigma_px * limited(problem.imageRatio()));
    double change = std::abs(std::log(sigma_px / start.settings.sigma_px));
    std::vector<StartedImu> imus = problem.restarted();
    for (std::size_t i = 0; i < imus.size(); ++i)
      change = std::max(change, changeOf(start.imus[i].noise, imus[i].noise));
    start = {start.settings, problem.cameras(), std::move(imus), problem.up()};
    start.settings.sigma_px = sigma_px;
    if (change < least_change || round == most_noise_rounds) return round;
  }
  return 0;
}

/// Estimates noise and values until corners that are linearised again at these values do not change the noise. If the
/// data leave something open, which the result of the fit says, the start stays as it is.
void estimateNoise(const Dataset& data, const std::vector<RigAtImage>& images, const Options& options,
                   double gravity, StreamStart& start) {
  const double least_px = start.settings.sigma_px;
  const StreamStart before = start;
  try {
    for (int round = 0; round < most_linearizations; ++round) {
      if (estimateNoise(data, images, options, gravity, least_px, start) < 2) return;
    }
  } catch (const slom::Error&) {  // the last fit may have moved a board behind a camera
    start = before;
  }
}

/// Removes what is left of lags that were found with the noise of a fit with these lags, and adds it to them.
void addRest(ForceLags rest, ForceLags& lags, UsableStreams& usable) {
  for (std::size_t i = 0; i < lags.size(); ++i) {
    if (!lags[i]) rest[i].reset();
    if (rest[i]) lags[i] = StreamNumber{lags[i]->value + rest[i]->value, rest[i]->std};
  }
  usable.remove(rest);
}

}  // namespace

PreparedStreams prepare(const Dataset& data, const std::vector<RigAtImage>& images, std::int64_t epoch_ns,
                        const Settings& settings, const CamerasAt& cameras, const StreamSettings& stream,
                        UsableStreams& usable) {
  const Options options = optionsOfStreams(settings);
  const double gravity = stream.gravity;
  /// Returns what to begin with, for the streams as they are then.
  const auto start = [&] {
    StreamStart begin{settings, cameras, startImus(usable.streams(), images, epoch_ns, stream), {}};
    for (std::size_t i = 0; i < begin.imus.size(); ++i) begin.imus[i].jumps = usable.jumps()[i];
    begin.up = upByForces(usable.streams().front(), images, begin.imus.front().start);
    return begin;
  };
  PreparedStreams prepared{start(), {}};
  StreamStart& now = prepared.start;
  if (usable.isRobust()) {
    if (usable.remove(findBiasJumps(data, now.settings, now.cameras, images, now.up, now.imus, gravity)))
      now = start();
    if (usable.remove(findGrossReadings(data, now.settings, now.cameras, images, now.up, now.imus, gravity)))
      now = start();
  }
  estimateNoise(data, images, options, gravity, now);
  prepared.lags = findForceLags(data, now.settings, now.cameras, images, now.up, now.imus, gravity, options);
  if (usable.remove(prepared.lags)) {
    now = start();
    estimateNoise(data, images, options, gravity, now);
    addRest(findForceLags(data, now.settings, now.cameras, images, now.up, now.imus, gravity, options, 0),
            prepared.lags, usable);
  }
  return prepared;
}

}  // namespace slom::calibration
