// The report of a calibration as one HTML page that needs no network and no other file.
#pragma once

#include <optional>
#include <string>

#include "calibrate/fitted_streams.hpp"
#include "calibrate/library.hpp"

namespace slom::app::calib {

/// Returns the page. `result.quality` must be set. `streams`: of IMUs in motion.
std::string toHtml(const Dataset& data, const Result& result,
                   const std::optional<FittedStreams>& streams = {});

}  // namespace slom::app::calib
