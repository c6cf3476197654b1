/// Formulas in long double, written out independently of mtk: rotations as matrices and quaternions, lenses
/// as OpenCV publishes them.
#pragma once

#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "measurements/kind.hpp"

namespace slom::testing {

using Long2 = Eigen::Matrix<Real, 2, 1>;
using Long3 = Eigen::Matrix<Real, 3, 1>;

template <class... T>
LongVector column(const T&... x) {
  LongVector v(sizeof...(T));
  int i = 0;
  ((v[i++] = x), ...);
  return v;
}
inline LongVector stacked(const LongVector& a, const LongVector& b) {
  LongVector v(a.size() + b.size());
  v << a, b;
  return v;
}

inline Eigen::Matrix<Real, 2, 2> matrix(const mtk::SO2<Real>& R) {
  const Real c = std::cos(R.angle()), s = std::sin(R.angle());
  Eigen::Matrix<Real, 2, 2> M;
  M << c, -s, s, c;
  return M;
}
/// R = I + 2 w [v]x + 2 [v]x [v]x for the unit quaternion (w, v).
inline Eigen::Matrix<Real, 3, 3> matrix(const mtk::SO3<Real>& R) {
  Eigen::Matrix<Real, 3, 3> V;
  V << 0, -R.z(), R.y(), R.z(), 0, -R.x(), -R.y(), R.x(), 0;
  return Eigen::Matrix<Real, 3, 3>::Identity() + 2 * R.w() * V + 2 * V * V;
}

/// The angle between -pi and pi.
inline Real wrapped(Real angle) { return std::remainder(angle, 2 * std::acos(Real(-1))); }

/// log(z^-1 a^-1 b) by products of quaternions.
inline LongVector rotationResidual(const mtk::SO3<Real>& a, const mtk::SO3<Real>& b,
                                   const mtk::SO3<Real>& z) {
  struct Q {
    Real w;
    Long3 v;
  };
  const auto quaternion = [](const mtk::SO3<Real>& R, int sign) {
    return Q{R.w(), sign * Long3(R.x(), R.y(), R.z())};
  };
  const auto times = [](const Q& p, const Q& q) {
    return Q{p.w * q.w - p.v.dot(q.v), p.w * q.v + q.w * p.v + p.v.cross(q.v)};
  };
  Q q = times(quaternion(z, -1), times(quaternion(a, -1), quaternion(b, 1)));
  if (q.w < 0) q = {-q.w, -q.v};
  const Real n = q.v.norm();
  return n == 0 ? LongVector(Long3::Zero()) : LongVector(2 * std::atan2(n, q.w) / n * q.v);
}
inline LongVector rotationResidual(const mtk::SO2<Real>& a, const mtk::SO2<Real>& b,
                                   const mtk::SO2<Real>& z) {
  return column(wrapped(b.angle() - a.angle() - z.angle()));
}

/// Returns arcs from the direction z to v (not zero), along the axes that mtk::S2 gives z.
inline LongVector directionResidual(const Long3& v, const mtk::S2<Real>& z) {
  return mtk::difference(mtk::S2<Real>(v), z);
}

// Lenses.

inline LongVector projected(const PinholeIntrinsics<Real>& c, const Long3& p) {
  Eigen::Matrix<Real, 3, 3> K;
  K << c[0], 0, c[2], 0, c[1], c[3], 0, 0, 1;
  const Long3 h = K * p;
  return h.head<2>() / h[2];
}
inline LongVector projected(const OpenCv5Intrinsics<Real>& c, const Long3& p) {
  const Real fx = c[0], fy = c[1], cx = c[2], cy = c[3], k1 = c[4], k2 = c[5], p1 = c[6], p2 = c[7],
             k3 = c[8];
  const Real x = p[0] / p[2], y = p[1] / p[2], r = std::hypot(x, y);
  const Real radial = 1 + k1 * std::pow(r, 2) + k2 * std::pow(r, 4) + k3 * std::pow(r, 6);
  return column(fx * (x * radial + 2 * p1 * x * y + p2 * (r * r + 2 * x * x)) + cx,
                fy * (y * radial + p1 * (r * r + 2 * y * y) + 2 * p2 * x * y) + cy);
}
inline LongVector projected(const FisheyeIntrinsics<Real>& c, const Long3& p) {
  const Real r = std::hypot(p[0], p[1]);
  const Real theta = std::atan2(r, p[2]);
  const Real theta_d = theta * (1 + c[4] * std::pow(theta, 2) + c[5] * std::pow(theta, 4) +
                                c[6] * std::pow(theta, 6) + c[7] * std::pow(theta, 8));
  const Real scale = r == 0 ? 1 / p[2] : theta_d / r;
  return column(c[0] * scale * p[0] + c[2], c[1] * scale * p[1] + c[3]);
}
inline LongVector projected(const SnavelyIntrinsics<Real>& c, const Long3& P) {
  const Long2 p = -P.head<2>() / P[2];
  const Real n = p.norm();
  return c[0] * (1 + c[1] * n * n + c[2] * n * n * n * n) * p;
}

}  // namespace slom::testing
