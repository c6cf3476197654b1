// The library that does the work, and its names among those of the subcommand.
#pragma once

#include <numbers>

#include <slom/calibration.hpp>

namespace slom::app::calib {

using namespace slom::calibration;

inline constexpr double degrees = 180 / std::numbers::pi;  ///< of a radian

}  // namespace slom::app::calib
