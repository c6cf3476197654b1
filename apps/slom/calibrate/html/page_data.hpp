// The data of the report page, as JSON inside its <script type="application/json">.
#pragma once

#include <optional>
#include <string>

#include "calibrate/fitted_streams.hpp"
#include "calibrate/library.hpp"

namespace slom::app::calib {

/// Returns the data. If there are many corners, images or parameters, keeps only as many as can be drawn, and the
/// page says so.
std::string pageData(const Dataset& data, const Result& result, const std::optional<FittedStreams>& streams);

}  // namespace slom::app::calib
