/// Range: a distance, from total stations, laser, ultra-wideband or sonar; with an unknown offset also pseudo-ranges.
///
///     est.insertMeasurement(slom::Range(), a, b, slom::measured(metres), slom::StandardDeviation(0.01));
///     est.insertMeasurement(slom::Range(), a, b, offset, slom::measured(metres), ...);
///
///   variables  a, b    points of 2 or 3 coordinates, or poses, whose positions count
///              offset  constant error that the instrument adds to each distance: a number or mtk::Scalar
///   datum      a number, in the unit of the coordinates
///   residual   |b - a| (+ offset) - z
/// If a and b are the same point, all directions are equal. The derivative is then that along the first axis, so a fit
/// leaves the point. Start values of a and b should differ.
#pragma once

#include <cmath>

#include "slom/measurements/point.hpp"

namespace slom {

struct Range {
  static constexpr bool is_vectorized = true;
  auto operator()(const auto& a, const auto& b) const {
    const auto difference = detail::positionOf(b) - detail::positionOf(a);
    return detail::lengthOf(difference);
  }
  auto operator()(const auto& a, const auto& b, const auto& offset) const {
    return (*this)(a, b) + detail::numberOf(offset);
  }
};

}  // namespace slom
