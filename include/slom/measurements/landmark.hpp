/// Landmark: coordinates of a landmark as seen from a pose, such as laser reflectors, fiducials or points of a scan.
///
///     est.insertMeasurement(slom::Landmark(), pose, landmark, slom::measured(z), noise);
///
///   variables  pose      world_T_sensor, mtk::trafo over SO2 or SO3
///              landmark  its 2 or 3 coordinates in the world; or a pose, whose position counts
///   datum      z         its coordinates in the sensor's frame, the same unit
///   residual   pose^-1 landmark - z, in the sensor's frame
#pragma once

#include "slom/measurements/point.hpp"

namespace slom {

struct Landmark {
  static constexpr bool is_vectorized = true;
  auto operator()(const auto& pose, const auto& landmark) const {
    return pose.orient.inverse() * (detail::positionOf(landmark) - pose.pos);
  }
};

}  // namespace slom
