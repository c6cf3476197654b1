// The quality of a calibration as JSON.
#pragma once

#include <nlohmann/json.hpp>

#include "calibrate/library.hpp"

namespace slom::app::calib {

nlohmann::ordered_json verdictJson(const Verdict& verdict);

/// Returns the quality. `result.quality` must be set.
nlohmann::ordered_json qualityJson(const Result& result);

}  // namespace slom::app::calib
