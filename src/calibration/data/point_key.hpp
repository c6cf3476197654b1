// Points of the board, by which corners of different images are the same.
#pragma once

#include <array>

#include "slom/calibration/types.hpp"

namespace slom::calibration {

/// The coordinates, in an order: corners at exactly the same place are the same point.
using PointKey = std::array<double, 3>;
inline PointKey keyOf(const vec3& point) { return {point.x(), point.y(), point.z()}; }

}  // namespace slom::calibration
