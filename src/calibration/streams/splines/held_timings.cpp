// Clocks and shutters that a fit does not estimate: what they would be.
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "calibration/streams/doubt.hpp"
#include "calibration/streams/splines/problem.hpp"
#include "slom/calibration/error.hpp"

namespace slom::calibration {

std::vector<CameraStreamResult> SplineProblem::heldTimings(const Options& options) const {
  SplineRecording freed = recording_;
  for (std::size_t c = 0; c < freed.clocks.size(); ++c)
    freed.clocks[c].is_offset_estimated = c > 0, freed.clocks[c].is_line_delay_estimated = true;
  SplineProblem problem(freed, values());
  if (!problem.optimize(options).converged) return {};
  std::vector<CameraStreamResult> held;
  const auto moved = [&](const VarID<mtk::Scalar<>>& now, const VarID<mtk::Scalar<>>& before) {
    return StreamNumber{double(*now) - double(*before), problem.est_.standardDeviation(now)[0]};
  };
  for (std::size_t c = 0; c < timings_.size(); ++c) {
    CameraStreamResult& camera = held.emplace_back();
    camera.name = recording_.data.cameras[c].name;
    const CameraClock& clock = recording_.clocks[c];
    if (c > 0 && !clock.is_offset_estimated)
      camera.time_offset = moved(problem.timings_[c].offset, timings_[c].offset);
    if (!clock.is_line_delay_estimated)
      camera.line_delay = moved(problem.timings_[c].line_delay, timings_[c].line_delay);
  }
  return held;
}

void SplineProblem::doubtHeldTimings(const Options& options, StreamResult& result) const {
  constexpr double least_deviations = 5, least_ms = 0.2, rows = 480;
  const auto isEstimated = [](const CameraClock& clock) {
    return clock.is_offset_estimated && clock.is_line_delay_estimated;
  };
  if (!result.success() || recording_.clocks.empty() || isEstimated(recording_.clocks.back())) return;
  std::vector<CameraStreamResult> held;
  try {
    held = heldTimings(options);
  } catch (const slom::Error&) {
    return;  // the result without them stands
  }
  const auto isFound = [](const std::optional<StreamNumber>& number, double ms_per_unit) {
    return number && std::abs(number->value) > least_deviations * number->std &&
           std::abs(number->value) * ms_per_unit > least_ms;
  };
  const char* const wrong = "the values are wrong without that; add ";
  for (const CameraStreamResult& camera : held) {
    if (isFound(camera.time_offset, 1e3))
      addDoubt(fmt::format("the recording fits better if the clock of {} differs by {:.2f} ms", camera.name,
                           1e3 * camera.time_offset->value),
               std::string(wrong) + "--camera-offsets.", result);
    if (isFound(camera.line_delay, 1e3 * rows))
      addDoubt(fmt::format("the recording fits better if {} has a line delay of {:.1f} us", camera.name,
                           1e6 * camera.line_delay->value),
               std::string(wrong) + "--rolling-shutter.", result);
  }
}

}  // namespace slom::calibration
