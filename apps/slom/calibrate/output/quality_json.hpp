// The quality of a calibration as JSON.
#pragma once

#include <nlohmann/json.hpp>

#include "calibrate/library.hpp"

namespace slom::app::calib {

/// `result.quality` must be there.
nlohmann::ordered_json qualityJson(const Result& result);

}  // namespace slom::app::calib
