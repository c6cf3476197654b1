// The result as JSON; docs/calibrate/results.md lists the keys.
#pragma once

#include <string>

#include "calibrate/library.hpp"

namespace slom::app::calib {

/// Returns all numbers with all digits; undetermined ones are null. `numbers`: how time stamps of the files were
/// paired.
std::string toJson(const Result& result, const ImageNumbers& numbers = {});

}  // namespace slom::app::calib
