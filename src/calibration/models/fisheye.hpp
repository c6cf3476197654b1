// OpenCV's fisheye, Kalibr's equidistant distortion.
//   source  OpenCV, namespace cv::fisheye
#pragma once

#include <cmath>
#include <string_view>

#include "calibration/models/camera.hpp"

namespace slom::calibration {

/// fx fy cx cy k1 k2 k3 k4: OpenCV's fisheye, Kalibr's pinhole-equi.
template <class S = double>
struct Fisheye : FisheyeIntrinsics<S> {
  static constexpr std::string_view model_name = "fisheye";
  using FisheyeIntrinsics<S>::FisheyeIntrinsics;

  static Fisheye fromPinhole(const Pinhole& p) { return {p.fx, p.fy, p.cx, p.cy, 0., 0., 0., 0.}; }
  Eigen::Matrix3d cameraMatrix() const {
    return Pinhole{this->fx(), this->fy(), this->cx(), this->cy()}.matrix();
  }
  /// Returns k1 k2 k3 k4.
  Eigen::VectorXd distortion() const { return this->template tail<4>(); }

  static constexpr StartLens start_lens = StartLens::equidistant;
  std::optional<ForeignLens> forOpencv() const { return withPinhole(*this, "", 4); }
  std::optional<ForeignLens> forRos() const { return withPinhole(*this, "equidistant", 4); }
  std::optional<ForeignLens> forKalibr() const { return withPinhole(*this, "equidistant", 4); }
};

/// Computes the derivatives by formulas written by hand; see docs/decisions/calibration_derivatives.md.
inline LensDerivatives<8> differentiate(const Fisheye<>& lens, const Eigen::Vector3d& point) {
  const double x = point.x(), y = point.y(), z = point.z(), r2 = x * x + y * y, R2 = r2 + z * z;
  const bool on_axis = z > 0 && r2 < 1e-15 * z * z;  // the limit of FisheyeIntrinsics
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

}  // namespace slom::calibration
