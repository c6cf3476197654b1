#include "calibration/streams/splines/fit.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "calibration/limits.hpp"
#include "calibration/streams/board_scale.hpp"
#include "slom/calibration/error.hpp"

namespace slom::calibration {
namespace {

constexpr int most_fits = 20;
constexpr double steady_noise = 0.02;  ///< of a standard deviation of noise, relative
/// Largest distance that a fit may move the values from those at which corners are condensed, in standard deviations.
constexpr double largest_move = 0.03;

/// Returns the largest relative change of a standard deviation of noise.
double noiseChange(const SplineValues& before, const SplineValues& after) {
  const auto change = [](double a, double b) { return std::abs(std::log(b / a)); };
  double most = change(before.sigma_px, after.sigma_px);
  for (std::size_t i = 0; i < before.imus.size(); ++i)
    most = std::max({most, change(before.imus[i].noise.gyro, after.imus[i].noise.gyro),
                     change(before.imus[i].noise.force, after.imus[i].noise.force)});
  return most;
}

void requireSpacing(double spacing) {
  constexpr double least = 0.001, most = 10;
  if (spacing >= least && spacing <= most) return;
  throw DataError(
      "slom.calibration.bad-settings",
      fmt::format("StreamSettings::knot_spacing is {}; give {:g} to {:g} s", spacing, least, most),
      "knot_spacing");
}

/// Returns the options of one fit. Its iterations are numbered from `before` on.
Options optionsOfFit(Options options, bool is_noise_found, const StreamSettings& stream, int before) {
  options.decrease_tolerance = 1e-6;  // the distance to the solution decides
  options.deviation_tolerance = is_noise_found ? largest_move / 2 : 0.3;
  if (stream.progress)
    options.observer = [&stream, before](IterationRecord record) {
      if (record.iteration == 0 && before > 0) return;
      record.iteration += before;
      stream.progress(record);
    };
  return options;
}

/// Returns the values with which the next fit begins. Nothing if the data leave something open, which the result says.
std::optional<SplineValues> valuesFor(const SplineProblem& problem, bool is_noise_found) {
  if (is_noise_found) return problem.values();
  try {
    return problem.withEstimatedNoise();
  } catch (const slom::Error&) {
    return std::nullopt;
  }
}

/// Returns how a fit ended. If values are such that cameras do not see the board, it has not converged.
Summary optimized(SplineProblem& problem, const Options& options) {
  try {
    return problem.optimize(options);
  } catch (const DataError&) {
    throw;
  } catch (const slom::Error&) {
    Summary failed;
    failed.converged = false;
    failed.message = "the readings pull the cameras to where they do not see the board";
    return failed;
  }
}

/// Declares the last fit not converged if it still moved the values.
void requireRest(double moved, Summary& summary) {
  if (moved < largest_move || !summary.converged) return;
  summary.converged = false;
  summary.message = fmt::format("the last of {} fits still moved the values by {:.2g} standard deviations",
                                most_fits, moved);
}

}  // namespace

BoardScale SplineProblem::boardScale(const Options& options) {
  est_.optimizeRV(board_scale_, true);
  if (!optimize(options).converged) return {};
  return boardScaleOf(est_, board_scale_, [&] { return byBlocks(); });
}

SplineValues valuesOf(const StreamStart& start) {
  return {start.settings.sigma_px, start.cameras, start.imus, start.up};
}

StreamResult fitBySplines(SplineRecording recording, SplineValues start, const StreamSettings& stream,
                          const Options& options, const std::function<void(const SplineProblem&)>& at_end) {
  requireSpacing(recording.knot_spacing);
  recording.stretches = stretchesOf(recording.images, start.imus, recording.knot_spacing);
  const double least_px = recording.settings.sigma_px;
  bool is_noise_found = false;
  int iterations = 0;
  for (int fit = 1;; ++fit) {
    SplineProblem problem(recording, start);
    Summary summary = optimized(problem, optionsOfFit(options, is_noise_found, stream, iterations));
    iterations += summary.iterations;
    summary.iterations = iterations;
    const bool may_go_on =
        summary.converged && fit < most_fits && reasonToEnd(recording.settings.limits).empty();
    const double moved = std::sqrt(std::max(0., summary.initial_rss - summary.final_rss));
    std::optional<SplineValues> next;
    if (may_go_on && !(is_noise_found && moved < largest_move)) next = valuesFor(problem, is_noise_found);
    if (!next) {
      if (fit == most_fits) requireRest(moved, summary);
      at_end(problem);
      StreamResult result = problem.result(summary);
      const Options once_more = optionsOfFit(options, true, {}, 0);
      problem.doubtHeldTimings(once_more, result);
      noteBoardScale([&] { return problem.boardScale(once_more); }, stream.axes, result);
      return result;
    }
    next->sigma_px = std::max(next->sigma_px, least_px);
    is_noise_found = is_noise_found || noiseChange(start, *next) < steady_noise;
    start = std::move(*next);
  }
}

}  // namespace slom::calibration
