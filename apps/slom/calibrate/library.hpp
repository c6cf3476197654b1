// The library that does the work, and its names among those of the subcommand.
#pragma once

#include <slom/calibration.hpp>

namespace slom::app::calib {

using namespace slom::calibration;

}  // namespace slom::app::calib
