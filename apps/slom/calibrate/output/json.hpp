// The result as JSON; docs/calibrate/json.md lists the keys.
#pragma once

#include <optional>
#include <string>

#include "calibrate/fitted_streams.hpp"
#include "calibrate/library.hpp"

namespace slom::app::calib {

/// Returns all numbers with all digits; undetermined ones are null. `numbers`: how time stamps of the files were
/// paired. `streams`: IMUs in motion, if there are any.
std::string toJson(const Result& result, const ImageNumbers& numbers = {},
                   const std::optional<FittedStreams>& streams = {});

}  // namespace slom::app::calib
