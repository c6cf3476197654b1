// The result as JSON; docs/calibrate.md lists the keys.
#pragma once

#include <string>

#include "calibrate/library.hpp"

namespace slom::app::calib {

/// All digits of all numbers; what is not determined is null.
std::string toJson(const Result& result);

}  // namespace slom::app::calib
