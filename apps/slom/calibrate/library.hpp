// The library that does the work. Its names are visible in the subcommand.
#pragma once

#include <numbers>

#include <slom/calibration.hpp>

namespace slom::app::calib {

using namespace slom::calibration;

inline constexpr double degrees = 180 / std::numbers::pi;  ///< in a radian

}  // namespace slom::app::calib
