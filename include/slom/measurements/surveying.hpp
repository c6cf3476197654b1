/// Angles of a levelled theodolite or total station. Its distances are slom::Range.
///
/// Points are (east, north) or (east, north, up), or poses, whose positions count. Angles are clockwise from north.
///     est.insertMeasurement(slom::Azimuth(), station, target, slom::measured(mtk::SO2<>(angle)), noise);
///     est.insertMeasurement(slom::HorizontalDirection(), station, target, orientation,
///                           slom::measured(mtk::SO2<>(reading)), noise);
///     est.insertMeasurement(slom::ZenithAngle(), station, target, slom::measured(mtk::SO2<>(angle)), noise);
///
///   datum      mtk::SO2<> of the angle [rad], so 0 and 400 gon are equal
///   residual   the difference of angles in [-pi, pi) [rad]
///   source     Ghilani and Wolf, "Adjustment computations", 2006, chapters 14 to 16
/// If one point is vertically above the other, there is no azimuth: the angle 0 with zero derivatives is taken. The
/// zenith angle then has the derivative along the first axis, so a fit leaves the place. Refraction and the curvature
/// of the Earth are ignored.
#pragma once

#include <cmath>

#include "mtk/types/so2.hpp"
#include "slom/measurements/point.hpp"

namespace slom {

/// Azimuth: atan2(east, north) of the vector from station to target.
struct Azimuth {
  static constexpr bool is_vectorized = true;
  auto operator()(const auto& station, const auto& target) const {
    using std::atan2;
    const auto way = detail::positionOf(target) - detail::positionOf(station);
    return mtk::SO2(atan2(way[0], way[1]));
  }
};

/// A reading of the horizontal circle: azimuth - orientation. The orientation is the azimuth of the circle's zero,
/// mtk::SO2<>, an unknown of each set-up.
struct HorizontalDirection {
  static constexpr bool is_vectorized = true;
  auto operator()(const auto& station, const auto& target, const auto& orientation) const {
    return orientation.inverse() * Azimuth()(station, target);
  }
};

/// The angle between the vertical and the vector from station to target, in [0, pi]; pi/2 is level.
struct ZenithAngle {
  static constexpr bool is_vectorized = true;
  auto operator()(const auto& station, const auto& target) const {
    using std::atan2;
    const auto way = detail::positionOf(target) - detail::positionOf(station);
    return mtk::SO2(atan2(detail::lengthOf(mtk::vector(way[0], way[1])), way[2]));
  }
};

}  // namespace slom
