/// RelativePose: one pose as seen from another (odometry, scan matching, loop closures). RelativeRotation: rotations
/// alone.
///
///     est.insertMeasurement(slom::RelativePose(), a, b, slom::measured(a_T_b), slom::InvCovariance(information));
///     est.insertMeasurement(slom::RelativeRotation(), a, b, slom::measured(a_R_b), noise);
///
/// A pose a is world_T_a: it moves points from a's frame to the world's. The datum z is the measured a_T_b.
///   residual  (translation, rotation vector) of E = z^-1 (a^-1 b): position [unit of the map] and rotation [rad], in
///             the frame where z puts b
///   source    Grisetti et al., "A tutorial on graph-based SLAM", 2010, section III; rotation averaging: Hartley et
///             al., "Rotation averaging", 2013, section 1
/// The information matrices of g2o files (EdgeSE2, EdgeSE3:QUAT) and the noise of GTSAM's BetweenFactor are in this
/// frame, too.
#pragma once

#include <string_view>

#include "mtk/types/trafo.hpp"
#include "slom/measurements/point.hpp"

namespace slom {

/// A pose b relative to a pose a: both in the plane, mtk::trafo<mtk::SO2<>>, or both in space, mtk::trafo<mtk::SO3<>>.
/// Datum: such a pose. Noise: in the frame of z.
struct RelativePose {
  static constexpr bool is_vectorized = true;
  /// A suffix, because files that call measurements "RelativePose" mean RelativePoseInFrameOfA.
  static constexpr std::string_view archive_suffix = " in the frame of z";

  auto operator()(const auto& a, const auto& b) const { return a.inverse() * b; }

  /// Returns the translation and the rotation of z^-1 y.
  static auto residualFromDatum(const auto& y, const auto& z) {
    const auto t = z.orient.inverse() * (y.pos - z.pos);
    if constexpr (requires { z.orient.angle(); }) {
      return mtk::vector(t[0], t[1], mtk::detail::wrapAngle(y.orient.angle() - z.orient.angle()));
    } else {
      const auto turn = z.orient.inverse() * y.orient;
      const auto v = decltype(z.orient.inverse() * y.orient)::log(turn);
      return mtk::vector(t[0], t[1], t[2], v[0], v[1], v[2]);
    }
  }
};

/// A relative pose with the translation in the frame of a: (t - t_z, rotation vector of R_z^-1 R) for a^-1 b = (t, R)
/// and z = (t_z, R_z). This is a^-1 b [-] z of mtk::trafo. Use it if the noise is stated along the axes of a, for
/// example for a range finder on a. The sum of squares is that of RelativePose if the noise of the translation is equal
/// in all directions and uncorrelated with that of the rotation.
struct RelativePoseInFrameOfA {
  static constexpr bool is_vectorized = true;
  static constexpr std::string_view archive_name = "RelativePose";

  auto operator()(const auto& a, const auto& b) const { return a.inverse() * b; }
};

/// The rotation of b relative to a. a, b: rotations or poses, whose orientations count. Datum: mtk::SO2<> or
/// mtk::SO3<>.
struct RelativeRotation {
  static constexpr bool is_vectorized = true;
  auto operator()(const auto& a, const auto& b) const {
    return detail::orientationOf(a).inverse() * detail::orientationOf(b);
  }
};

}  // namespace slom
