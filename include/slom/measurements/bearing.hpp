/// Bearing: the direction of a landmark as seen from a pose.
///
///     est.insertMeasurement(slom::Bearing(), pose, landmark, slom::measured(mtk::SO2<>(angle)), noise);
///     est.insertMeasurement(slom::Bearing(), pose, landmark, slom::measured(mtk::S2<>(direction)), noise);
///
///   variables  pose      world_T_sensor, mtk::trafo over SO2 or SO3
///              landmark  its 2 or 3 coordinates in the world; or a pose, whose position counts
///   datum      2D  mtk::SO2<>, the angle from the sensor's x axis towards its y axis
///              3D  mtk::S2<>, the direction in the sensor's frame
///   residual   2D  the difference of angles in [-pi, pi) [rad], so bearings near +-pi are safe
///              3D  prediction [-] z on the sphere, 2 arcs [rad]
/// A landmark at the sensor's own position has no direction: 2D takes the angle 0 with zero derivatives, 3D throws
/// [mtk.no-direction].
#pragma once

#include <cmath>

#include "mtk/types/s2.hpp"
#include "slom/measurements/point.hpp"

namespace slom {

struct Bearing {
  static constexpr bool is_vectorized = true;
  auto operator()(const auto& pose, const auto& landmark) const {
    const auto seen = pose.orient.inverse() * (detail::positionOf(landmark) - pose.pos);
    if constexpr (decltype(seen)::DOF == 2) {
      using std::atan2;
      return mtk::SO2(atan2(seen[1], seen[0]));
    } else {
      return mtk::S2<typename decltype(seen)::scalar>(seen);
    }
  }
};

}  // namespace slom
