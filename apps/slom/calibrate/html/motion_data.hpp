// IMUs in motion as data of the report page.
#pragma once

#include <nlohmann/json.hpp>

#include "calibrate/fitted_streams.hpp"

namespace slom::app::calib {

/// Returns pose, clock, residuals over time, noise at rest and path. If there are many images, keeps every n-th.
nlohmann::ordered_json motionJson(const FittedStreams& fitted);

}  // namespace slom::app::calib
