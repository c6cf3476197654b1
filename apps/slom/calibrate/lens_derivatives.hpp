// Pixels and how they change with the lens and the point: written out by hand, because a fit, its covariances
// and what the report draws ask for little else.
#pragma once

#include <cmath>

#include "calibrate/camera_models.hpp"

namespace slom::app::calib {

/// N: number of the lens parameters, in their order.
template <int N>
struct LensDerivatives {
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, N> by_parameters;
  Eigen::Matrix<double, 2, 3> by_point;  ///< [px/m]
};

namespace detail {

/// Of opencv8, or of a model that has the first N of its parameters.
template <int N>
LensDerivatives<N> differentiateOpencv(const double* c, const Eigen::Vector3d& point) {
  const auto parameter = [&](int i) { return i < N ? c[i] : 0.0; };
  const double fx = c[0], fy = c[1], k1 = parameter(4), k2 = parameter(5), p1 = parameter(6),
               p2 = parameter(7), k3 = parameter(8), k4 = parameter(9), k5 = parameter(10),
               k6 = parameter(11);
  const double w = 1 / slom::detail::depthInFront(point.z()), x = point.x() * w, y = point.y() * w;
  const double xx = x * x, yy = y * y, xy2 = 2 * x * y, r2 = xx + yy;
  const double over = N > 9 ? 1 / (1 + r2 * (k4 + r2 * (k5 + r2 * k6))) : 1;  // 1 / denominator
  const double g = (1 + r2 * (k1 + r2 * (k2 + r2 * k3))) * over;
  const double g_by_r2 =
      (k1 + r2 * (2 * k2 + r2 * 3 * k3) - (N > 9 ? g * (k4 + r2 * (2 * k5 + r2 * 3 * k6)) : 0)) * over;
  const double x_distorted = x * g + p1 * xy2 + p2 * (r2 + 2 * xx),
               y_distorted = y * g + p1 * (r2 + 2 * yy) + p2 * xy2;

  LensDerivatives<N> d;
  d.pixel << fx * x_distorted + c[2], fy * y_distorted + c[3];
  auto& J = d.by_parameters;
  J.col(0) << x_distorted, 0;
  J.col(1) << 0, y_distorted;
  J.col(2) << 1, 0;
  J.col(3) << 0, 1;
  const Eigen::Vector2d radial(fx * x * over * r2, fy * y * over * r2);
  if constexpr (N > 4) J.col(4) = radial;
  if constexpr (N > 5) {
    J.col(5) = radial * r2;
    J.col(6) << fx * xy2, fy * (r2 + 2 * yy);
    J.col(7) << fx * (r2 + 2 * xx), fy * xy2;
  }
  if constexpr (N > 8) J.col(8) = J.col(5) * r2;
  if constexpr (N > 9) {
    J.col(9) = -g * radial;
    J.col(10) = J.col(9) * r2;
    J.col(11) = J.col(10) * r2;
  }
  const double x_by_x = g + 2 * xx * g_by_r2 + 2 * p1 * y + 6 * p2 * x;
  const double x_by_y = xy2 * g_by_r2 + 2 * p1 * x + 2 * p2 * y;  // and y by x
  const double y_by_y = g + 2 * yy * g_by_r2 + 6 * p1 * y + 2 * p2 * x;
  const double u = fx * w, v = fy * w;
  d.by_point << u * x_by_x, u * x_by_y, -u * (x_by_x * x + x_by_y * y),  //
      v * x_by_y, v * y_by_y, -v * (x_by_y * x + y_by_y * y);
  return d;
}

}  // namespace detail

inline auto differentiate(const Opencv4<>& lens, const Eigen::Vector3d& point) {
  return detail::differentiateOpencv<8>(lens.data(), point);
}
inline auto differentiate(const Opencv5<>& lens, const Eigen::Vector3d& point) {
  return detail::differentiateOpencv<9>(lens.data(), point);
}
inline auto differentiate(const Opencv8<>& lens, const Eigen::Vector3d& point) {
  return detail::differentiateOpencv<12>(lens.data(), point);
}

inline auto differentiate(const Radial1<>& lens, const Eigen::Vector3d& point) {
  const double c[] = {lens[0], lens[0], lens[1], lens[2], lens[3]};
  const auto free = detail::differentiateOpencv<5>(c, point);
  LensDerivatives<4> d{free.pixel, {}, free.by_point};
  d.by_parameters << free.by_parameters.col(0) + free.by_parameters.col(1), free.by_parameters.rightCols<3>();
  return d;
}

inline LensDerivatives<8> differentiate(const Fisheye<>& lens, const Eigen::Vector3d& point) {
  const double x = point.x(), y = point.y(), z = point.z(), r2 = x * x + y * y, R2 = r2 + z * z;
  const bool on_axis = z > 0 && r2 < 1e-15 * z * z;  // as FisheyeIntrinsics
  const double r = std::sqrt(r2), angle_by_r = on_axis ? (1 - r2 / (3 * z * z)) / z : std::atan2(r, z) / r;
  const double t2 = angle_by_r * angle_by_r * r2;
  const double k1 = lens.k1(), k2 = lens.k2(), k3 = lens.k3(), k4 = lens.k4();
  const double scale = angle_by_r * (1 + t2 * (k1 + t2 * (k2 + t2 * (k3 + t2 * k4))));  // distorted angle / r
  const double by_angle = 1 + t2 * (3 * k1 + t2 * (5 * k2 + t2 * (7 * k3 + t2 * 9 * k4)));
  // Derivative of scale by r, over r; its limit on the axis.
  const double slope = on_axis ? (2 * k1 - 2.0 / 3) / (z * z * z) : (by_angle * z / R2 - scale) / r2;
  LensDerivatives<8> d;
  d.pixel << lens.fx() * scale * x + lens.cx(), lens.fy() * scale * y + lens.cy();
  auto& J = d.by_parameters;
  J.leftCols<4>() << scale * x, 0, 1, 0, 0, scale * y, 0, 1;
  J.col(4) << lens.fx() * angle_by_r * t2 * x, lens.fy() * angle_by_r * t2 * y;
  for (int i = 5; i < 8; ++i) J.col(i) = J.col(i - 1) * t2;
  const double by_z = -by_angle / R2;
  d.by_point << lens.fx() * (scale + x * x * slope), lens.fx() * x * y * slope, lens.fx() * x * by_z,
      lens.fy() * x * y * slope, lens.fy() * (scale + y * y * slope), lens.fy() * y * by_z;
  return d;
}

}  // namespace slom::app::calib
