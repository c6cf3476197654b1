// Points of the board, which identify corners across images.
#pragma once

#include <array>

#include "slom/calibration/types.hpp"

namespace slom::calibration {

/// The coordinates as a sortable key. Corners at exactly the same coordinates are the same point.
using PointKey = std::array<double, 3>;
inline PointKey keyOf(const vec3& point) { return {point.x(), point.y(), point.z()}; }

}  // namespace slom::calibration
