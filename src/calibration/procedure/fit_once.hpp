// The calibration without the search for views that contradict the others, which is long in a recording.
#pragma once

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/options.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// Fits all views, without gross corners. Throws as calibrate().
Result fitOnce(const Dataset& data, const Settings& settings);

}  // namespace slom::calibration
