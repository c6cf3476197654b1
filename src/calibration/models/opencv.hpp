// OpenCV's lenses of polynomials. radial1 is the first of them with square pixels and only k1.
//   point   (X, Y, Z) in the camera: X right, Y down, Z forward            [m]
//   pixel   (u, v) = (fx x' + cx, fy y' + cy), (x', y') = distorted (X/Z, Y/Z)   [px]
//   source  OpenCV, "Camera Calibration and 3D Reconstruction"
#pragma once

#include <array>
#include <string_view>

#include "calibration/models/camera.hpp"

namespace slom::calibration {

/// fx fy cx cy k1 k2 p1 p2 k3, as in OpenCV.
template <class S = double>
struct Opencv5 : OpenCv5Intrinsics<S> {
  static constexpr std::string_view model_name = "opencv5";
  using OpenCv5Intrinsics<S>::OpenCv5Intrinsics;

  static Opencv5 fromPinhole(const Pinhole& p) { return {p.fx, p.fy, p.cx, p.cy, 0., 0., 0., 0., 0.}; }
  Eigen::Matrix3d cameraMatrix() const {
    return Pinhole{this->fx(), this->fy(), this->cx(), this->cy()}.matrix();
  }
  /// Returns k1 k2 p1 p2 k3, in OpenCV's order.
  Eigen::VectorXd distortion() const { return this->template tail<5>(); }

  static constexpr StartLens start_lens = StartLens::pinhole;
  std::optional<ForeignLens> forOpencv() const { return withPinhole(*this, "", 5); }
  std::optional<ForeignLens> forRos() const { return withPinhole(*this, "plumb_bob", 5); }
  std::optional<ForeignLens> forKalibr() const { return {}; }
};

/// opencv5 with k3 = 0.
template <class S = double>
struct Opencv4 : slom::detail::CentredLens<8, S> {
  static constexpr std::string_view model_name = "opencv4";
  static constexpr std::array<std::string_view, 8> component_names{"fx", "fy", "cx", "cy",
                                                                   "k1", "k2", "p1", "p2"};
  using slom::detail::CentredLens<8, S>::CentredLens;

  static Opencv4 fromPinhole(const Pinhole& p) { return {p.fx, p.fy, p.cx, p.cy, 0., 0., 0., 0.}; }
  Eigen::Matrix3d cameraMatrix() const {
    return Pinhole{this->fx(), this->fy(), this->cx(), this->cy()}.matrix();
  }
  Eigen::VectorXd distortion() const {
    return (Eigen::VectorXd(5) << this->template tail<4>(), 0).finished();
  }
  auto project(const auto& point) const {
    const Opencv4& c = *this;
    return OpenCv5Intrinsics<S>(c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7], S(0.0)).project(point);
  }

  static constexpr StartLens start_lens = StartLens::pinhole;
  std::optional<ForeignLens> forOpencv() const { return withPinhole(*this, "", 5); }
  std::optional<ForeignLens> forRos() const { return withPinhole(*this, "plumb_bob", 5); }
  std::optional<ForeignLens> forKalibr() const { return withPinhole(*this, "radtan", 4); }
};

/// opencv5 with the radial factor divided by 1 + k4 r2 + k5 r2^2 + k6 r2^3: OpenCV's rational model.
template <class S = double>
struct Opencv8 : slom::detail::CentredLens<12, S> {
  static constexpr std::string_view model_name = "opencv8";
  static constexpr std::array<std::string_view, 12> component_names{"fx", "fy", "cx", "cy", "k1", "k2",
                                                                    "p1", "p2", "k3", "k4", "k5", "k6"};
  using slom::detail::CentredLens<12, S>::CentredLens;

  static Opencv8 fromPinhole(const Pinhole& p) {
    return {p.fx, p.fy, p.cx, p.cy, 0., 0., 0., 0., 0., 0., 0., 0.};
  }
  Eigen::Matrix3d cameraMatrix() const {
    return Pinhole{this->fx(), this->fy(), this->cx(), this->cy()}.matrix();
  }
  Eigen::VectorXd distortion() const { return this->template tail<8>(); }
  auto project(const auto& point) const {
    const Opencv8& c = *this;
    const auto z = slom::detail::depthInFront(point[2]);
    const auto x = point[0] / z, y = point[1] / z;
    const auto xx = x * x, yy = y * y, xy2 = 2.0 * x * y, r2 = xx + yy;
    const auto radial =
        (1.0 + r2 * (c[4] + r2 * (c[5] + r2 * c[8]))) / (1.0 + r2 * (c[9] + r2 * (c[10] + r2 * c[11])));
    return this->toPixels(x * radial + c[6] * xy2 + c[7] * (r2 + 2.0 * xx),
                          y * radial + c[6] * (r2 + 2.0 * yy) + c[7] * xy2);
  }

  static constexpr StartLens start_lens = StartLens::pinhole;
  static constexpr std::array<int, 3> held_near_zero{
      9, 10, 11};  ///< numerator and denominator can have the same effect
  std::optional<ForeignLens> forOpencv() const { return withPinhole(*this, "", 8); }
  std::optional<ForeignLens> forRos() const { return withPinhole(*this, "rational_polynomial", 8); }
  std::optional<ForeignLens> forKalibr() const { return {}; }
};

/// f cx cy k1: square pixels and the radial factor 1 + k1 r2.
template <class S = double>
struct Radial1 : mtk::vect<4, S> {
  static constexpr std::string_view model_name = "radial1";
  static constexpr std::array<std::string_view, 4> component_names{"f", "cx", "cy", "k1"};
  using mtk::vect<4, S>::vect;

  static Radial1 fromPinhole(const Pinhole& p) { return {(p.fx + p.fy) / 2, p.cx, p.cy, 0.}; }
  Eigen::Matrix3d cameraMatrix() const {
    return Pinhole{(*this)[0], (*this)[0], (*this)[1], (*this)[2]}.matrix();
  }
  Eigen::VectorXd distortion() const { return (Eigen::VectorXd(5) << (*this)[3], 0, 0, 0, 0).finished(); }
  auto project(const auto& point) const {
    const Radial1& c = *this;
    return OpenCv5Intrinsics<S>(c[0], c[0], c[1], c[2], c[3], S(0.0), S(0.0), S(0.0), S(0.0)).project(point);
  }

  static constexpr StartLens start_lens = StartLens::pinhole;
  std::optional<ForeignLens> forOpencv() const { return withPinhole(*this, "", 5); }
  std::optional<ForeignLens> forRos() const { return withPinhole(*this, "plumb_bob", 5); }
  std::optional<ForeignLens> forKalibr() const { return withPinhole(*this, "radtan", 4); }
};

// Derivatives written by hand, because a fit, its covariances and the figures of the report compute little else;
// see docs/decisions/calibration_derivatives.md.

namespace detail {

/// Computes derivatives of opencv8, or of a model with the first N of its parameters.
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

}  // namespace slom::calibration
