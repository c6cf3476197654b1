// The fit of cameras and IMUs by splines.
#pragma once

#include <functional>

#include "calibration/streams/preparation.hpp"
#include "calibration/streams/splines/problem.hpp"

namespace slom::calibration {

/// Returns what a fit by splines begins with.
SplineValues valuesOf(const StreamStart& start);

/// Fits from start values, and estimates the noise of corners and readings in turn with the values, until it stays the
/// same. Corners are at least as noisy as the settings of the recording say. `recording` needs no stretches yet. Calls `at_end` with the last fit. Throws DataError
/// [slom.calibration.bad-settings] if the knot spacing is out of range.
StreamResult fitBySplines(SplineRecording recording, SplineValues start, const StreamSettings& stream,
                          const Options& options, const std::function<void(const SplineProblem&)>& at_end);

}  // namespace slom::calibration
