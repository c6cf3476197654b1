/// QuaternionError: the error of an edge in space as in g2o.
#pragma once

#include "mtk/mtk.hpp"

namespace slom::io {

/// Poses a, b and the measurement z of a^-1 b, all mtk::trafo<mtk::SO3<>>.
///   residual  t_ab - t_z, as in slom::RelativePoseInFrameOfA; then the vector part of the unit quaternion of
///             z^-1 (a^-1 b) with w >= 0, which is half the rotation vector for small errors
///   source    Kuemmerle, Grisetti, Strasdat, Konolige and Burgard, "g2o: a general framework for graph optimization",
///             ICRA 2011
struct QuaternionError {
  static constexpr bool is_vectorized = true;
  auto operator()(const auto& a, const auto& b, const auto& z) const {
    using mtk::select;
    const auto ab = a.inverse() * b;
    const auto t = ab.pos - z.pos;
    const auto q = z.orient.inverse() * ab.orient;
    const auto w = q.w(), x = q.x(), y = q.y(), z_part = q.z();
    return mtk::vector(t[0], t[1], t[2], select(w < 0.0, -x, x), select(w < 0.0, -y, y),
                       select(w < 0.0, -z_part, z_part));
  }
};

}  // namespace slom::io
