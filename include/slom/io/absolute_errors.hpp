/// Residuals of g2o's measurements in the frame of the world.
#pragma once

#include "mtk/mtk.hpp"
#include "slom/measurements/relative_pose.hpp"

namespace slom::io {

/// Prior of a pose x, or of a sensor at place o on it; z is the measured pose of the sensor in the world.
///   residual  translation and rotation of z^-1 (x o), as in slom::RelativePose
///   source    g2o, EdgeSE3Prior and EdgeSE2Prior
struct PosePriorError {
  static constexpr bool is_vectorized = true;
  auto operator()(const auto& x, const auto& o) const { return x * o; }
  /// Returns z^-1 y as in slom::RelativePose.
  static auto residualFromDatum(const auto& y, const auto& z) {
    return RelativePose::residualFromDatum(y, z);
  }
};

/// PosePriorError in space with the vector part of the unit quaternion with w >= 0, as in g2o.
struct PosePriorQuaternionError {
  static constexpr bool is_vectorized = true;
  auto operator()(const auto& x, const auto& o, const auto& z) const {
    using mtk::select;
    const auto y = x * o;
    const auto t = z.orient.inverse() * (y.pos - z.pos);
    const auto q = z.orient.inverse() * y.orient;
    const auto w = q.w(), x_part = q.x(), y_part = q.y(), z_part = q.z();
    return mtk::vector(t[0], t[1], t[2], select(w < 0.0, -x_part, x_part), select(w < 0.0, -y_part, y_part),
                       select(w < 0.0, -z_part, z_part));
  }
};

/// The position of a pose.
///   residual  position - z
///   source    g2o, EdgeSE2XYPrior
struct PositionPriorError {
  static constexpr bool is_vectorized = true;
  auto operator()(const auto& x) const { return x.pos; }
};

}  // namespace slom::io
