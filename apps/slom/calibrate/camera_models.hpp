// Camera models: the intrinsics as a variable, and where they put a point.
//   point   (X, Y, Z) in the camera: X right, Y down, Z forward, Z > 0     [m]
//   pixel   (u, v) = (fx x' + cx, fy y' + cy), (x', y') = distorted (X/Z, Y/Z)   [px]
//   source  OpenCV, "Camera Calibration and 3D Reconstruction"; radial1 is its k1 alone, with square pixels
#pragma once

#include <array>
#include <string_view>

#include "calibrate/types.hpp"

namespace slom::app::calib {

/// What start values know of a camera: a pinhole with no distortion.
struct Pinhole {
  double fx = 0, fy = 0, cx = 0, cy = 0;  // [px]

  Eigen::Matrix3d matrix() const { return (Eigen::Matrix3d() << fx, 0, cx, 0, fy, cy, 0, 0, 1).finished(); }
};

/// fx fy cx cy k1 k2 p1 p2 k3, as in OpenCV:
///   g = 1 + k1 r2 + k2 r2^2 + k3 r2^3,  x' = x g + 2 p1 x y + p2 (r2 + 2 x^2),  y' = y g + p1 (r2 + 2 y^2) +
///   2 p2 x y
template <class S = double>
struct Opencv5 : mtk::vect<9, S> {
  using mtk::vect<9, S>::vect;
  using mtk::vect<9, S>::operator=;
  static constexpr std::string_view model_name = "opencv5";
  static constexpr std::array<std::string_view, 9> component_names{"fx", "fy", "cx", "cy", "k1",
                                                                   "k2", "p1", "p2", "k3"};

  static Opencv5 fromPinhole(const Pinhole& p) { return {p.fx, p.fy, p.cx, p.cy, 0., 0., 0., 0., 0.}; }
  Eigen::Matrix3d cameraMatrix() const;
  /// k1 k2 p1 p2 k3
  Eigen::Matrix<double, 5, 1> distortion() const;

  template <class Point>
  mtk::vect<2, S> project(const Point& point) const;
};

/// Opencv5 with k3 = 0.
template <class S = double>
struct Opencv4 : mtk::vect<8, S> {
  using mtk::vect<8, S>::vect;
  using mtk::vect<8, S>::operator=;
  static constexpr std::string_view model_name = "opencv4";
  static constexpr std::array<std::string_view, 8> component_names{"fx", "fy", "cx", "cy",
                                                                   "k1", "k2", "p1", "p2"};

  static Opencv4 fromPinhole(const Pinhole& p) { return {p.fx, p.fy, p.cx, p.cy, 0., 0., 0., 0.}; }
  Eigen::Matrix3d cameraMatrix() const;
  Eigen::Matrix<double, 5, 1> distortion() const;

  template <class Point>
  mtk::vect<2, S> project(const Point& point) const;
};

/// f cx cy k1: square pixels and the radial factor 1 + k1 r2.
template <class S = double>
struct Radial1 : mtk::vect<4, S> {
  using mtk::vect<4, S>::vect;
  using mtk::vect<4, S>::operator=;
  static constexpr std::string_view model_name = "radial1";
  static constexpr std::array<std::string_view, 4> component_names{"f", "cx", "cy", "k1"};

  static Radial1 fromPinhole(const Pinhole& p) { return {(p.fx + p.fy) / 2, p.cx, p.cy, 0.}; }
  Eigen::Matrix3d cameraMatrix() const;
  Eigen::Matrix<double, 5, 1> distortion() const;

  template <class Point>
  mtk::vect<2, S> project(const Point& point) const;
};

// ---- implementation
// ------------------------------------------------------------------------------------------

namespace detail {

/// OpenCV's distortion of (x, y) = (X/Z, Y/Z).
template <class S>
mtk::vect<2, S> distorted(const S& x, const S& y, const S& k1, const S& k2, const S& p1, const S& p2,
                          const S& k3) {
  const S r2 = x * x + y * y;
  const S g = S(1) + r2 * (k1 + r2 * (k2 + r2 * k3));
  const S two_xy = S(2) * x * y;
  return {S(x * g + p1 * two_xy + p2 * (r2 + S(2) * x * x)),
          S(y * g + p1 * (r2 + S(2) * y * y) + p2 * two_xy)};
}

}  // namespace detail

template <class S>
template <class Point>
mtk::vect<2, S> Opencv5<S>::project(const Point& point) const {
  const Opencv5& c = *this;
  const mtk::vect<2, S> d =
      detail::distorted<S>(point[0] / point[2], point[1] / point[2], c[4], c[5], c[6], c[7], c[8]);
  return {S(c[0] * d[0] + c[2]), S(c[1] * d[1] + c[3])};
}

template <class S>
template <class Point>
mtk::vect<2, S> Opencv4<S>::project(const Point& point) const {
  const Opencv4& c = *this;
  const mtk::vect<2, S> d =
      detail::distorted<S>(point[0] / point[2], point[1] / point[2], c[4], c[5], c[6], c[7], S(0));
  return {S(c[0] * d[0] + c[2]), S(c[1] * d[1] + c[3])};
}

template <class S>
template <class Point>
mtk::vect<2, S> Radial1<S>::project(const Point& point) const {
  const Radial1& c = *this;
  const S x = point[0] / point[2], y = point[1] / point[2];
  const S factor = c[0] * (S(1) + c[3] * (x * x + y * y));
  return {S(factor * x + c[1]), S(factor * y + c[2])};
}

template <class S>
Eigen::Matrix3d Opencv5<S>::cameraMatrix() const {
  return Pinhole{(*this)[0], (*this)[1], (*this)[2], (*this)[3]}.matrix();
}
template <class S>
Eigen::Matrix3d Opencv4<S>::cameraMatrix() const {
  return Pinhole{(*this)[0], (*this)[1], (*this)[2], (*this)[3]}.matrix();
}
template <class S>
Eigen::Matrix3d Radial1<S>::cameraMatrix() const {
  return Pinhole{(*this)[0], (*this)[0], (*this)[1], (*this)[2]}.matrix();
}

template <class S>
Eigen::Matrix<double, 5, 1> Opencv5<S>::distortion() const {
  return this->template tail<5>();
}
template <class S>
Eigen::Matrix<double, 5, 1> Opencv4<S>::distortion() const {
  return (Eigen::Matrix<double, 5, 1>() << this->template tail<4>(), 0).finished();
}
template <class S>
Eigen::Matrix<double, 5, 1> Radial1<S>::distortion() const {
  return {(*this)[3], 0, 0, 0, 0};
}

}  // namespace slom::app::calib
