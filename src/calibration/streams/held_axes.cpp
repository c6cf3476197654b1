#include "calibration/streams/held_axes.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calibration/streams/check.hpp"
#include "calibration/streams/doubt.hpp"
#include "calibration/streams/joint_fit.hpp"
#include "slom/calibration/error.hpp"
#include "slom/calibration/number_text.hpp"
#include "slom/calibration/stream_agreement.hpp"

namespace slom::calibration {
namespace {

constexpr double significant = 5;   // standard deviations of an error of an axis
constexpr double far_away = 3;      // standard deviations that the pose or the clock moves
constexpr double much_smaller = 3;  // residuals

/// Returns how far the poses and clocks of the IMUs move from one fit to another, in standard deviations of the first.
StreamAgreement movesOf(const StreamResult& held, const StreamResult& freed) {
  StreamResult moved = held;
  for (std::size_t i = 0; i < held.imus.size(); ++i) {
    moved.imus[i].left2imu = freed.imus[i].left2imu;
    moved.imus[i].time_offset = freed.imus[i].time_offset;
  }
  return agreementOf(held, moved);
}

/// Doubts IMUs whose pose or clock moves far in a fit with errors of axes, if these are significant.
void doubtByMoves(const StreamProblem& problem, const StreamResult& freed, StreamResult& result) {
  const StreamAgreement move = movesOf(result, freed);
  for (std::size_t i = 0; i < result.imus.size(); ++i) {
    const auto [deviations, name] = move.imus[i].largest();
    if (deviations > far_away && problem.hasErrorOfAxes(i, significant))
      addDoubt(fmt::format("with estimated scales and axes of {}, {} moves by {} standard deviations",
                           result.imus[i].name, name, twoDigits(deviations)),
               "add --imu-model scale-misalignment.", result);
  }
}

/// Doubts the axes if errors of them explain most of large residuals; in part, they explain other causes, too.
void doubtByResiduals(const StreamResult& freed, StreamResult& result) {
  const double times = excessOf(result) / excessOf(freed);
  if (times > much_smaller)
    addDoubt(
        fmt::format(
            "the scales or axes of the IMU are not as stated, because residuals are {} times as large as with "
            "estimated ones",
            twoDigits(times)),
        "add --imu-model scale-misalignment.", result);
}

}  // namespace

std::vector<StartedImu> startedAt(const StreamResult& result, std::vector<StartedImu> imus) {
  for (std::size_t i = 0; i < imus.size(); ++i) {
    const ImuStreamResult& fitted = result.imus[i];
    imus[i].start = {fitted.time_offset, fitted.left2imu.orient, fitted.gyro_bias};
    imus[i].noise = fitted.noise;
    imus[i].left2imu = fitted.left2imu;
    imus[i].force_bias = fitted.force_bias;
    imus[i].axes = fitted.axes.estimated;
    imus[i].model = fitted.axes.model;
  }
  return imus;
}

void doubtHeldAxes(const Dataset& data, const Settings& settings, const CamerasAt& cameras,
                   const std::vector<RigAtImage>& images, std::vector<StartedImu> imus, double gravity,
                   const Options& options, StreamResult& result) {
  const auto is_saturated = [](const StartedImu& imu) { return isSaturated(*imu.stream); };
  if (!result.success() || std::any_of(imus.begin(), imus.end(), is_saturated)) return;
  try {
    Settings at = settings;
    at.sigma_px = result.sigma_px;
    imus = startedAt(result, std::move(imus));
    for (StartedImu& imu : imus) imu.axes = ImuAxes::scale_misalignment;
    StreamProblem problem(data, condensed(data, cameras), at, cameras, images,
                          mtk::S2<>(vec3(-result.gravity)), imus, gravity);
    problem.freeBoardScale();
    if (!problem.optimize(options).converged) return;
    StreamResult freed;
    freed.imus = problem.posesAndRatios();
    excessOf(result) > 1 ? doubtByResiduals(freed, result) : doubtByMoves(problem, freed, result);
  } catch (const slom::Error&) {
    return;  // the result without the errors stands
  }
}

}  // namespace slom::calibration
