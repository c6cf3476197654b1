/// One pose as seen from another: odometry, scan matching, loop closures; and rotations alone.
///
///     est.insertMeasurement(slom::RelativePose(), a, b, slom::measured(a_T_b), noise);
///     est.insertMeasurement(slom::RelativeRotation(), a, b, slom::measured(a_R_b), noise);
///
/// A pose a is world_T_a: it moves points of a's frame to the world's.
///   residual  a^-1 b [-] z: position (in a's frame, unit of the map), then rotation [rad] as seen in b's frame
///   source    Grisetti et al., "A tutorial on graph-based SLAM", 2010, section III, with [-] of mtk::trafo;
///             rotation averaging: Hartley et al., "Rotation averaging", 2013, section 1
#pragma once

#include "slom/measurements/point.hpp"

namespace slom {

/// Poses a, b: both in the plane, mtk::trafo<mtk::SO2<>>, or both in space, mtk::trafo<mtk::SO3<>>. Datum:
/// such a pose.
struct RelativePose {
  static constexpr bool is_vectorized = true;
  auto operator()(const auto& a, const auto& b) const { return a.inverse() * b; }
};

/// Rotations or poses a, b, of which the orientations count. Datum: mtk::SO2<> or mtk::SO3<>.
struct RelativeRotation {
  static constexpr bool is_vectorized = true;
  auto operator()(const auto& a, const auto& b) const {
    return detail::orientationOf(a).inverse() * detail::orientationOf(b);
  }
};

}  // namespace slom
