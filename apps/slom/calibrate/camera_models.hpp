// Camera models: the library's lenses, and those that are made of them, with what a calibration wants to know of each.
//   point   (X, Y, Z) in the camera: X right, Y down, Z forward            [m]
//   pixel   (u, v) = (fx x' + cx, fy y' + cy), (x', y') = distorted (X/Z, Y/Z)   [px]
//   source  OpenCV, "Camera Calibration and 3D Reconstruction"; radial1 is its k1 alone, with square pixels
#pragma once

#include <array>
#include <string_view>

#include <slom/measurements/intrinsics.hpp>

#include "calibrate/types.hpp"

namespace slom::app::calib {

/// What start values know of a camera: a pinhole with no distortion.
struct Pinhole {
  double fx = 0, fy = 0, cx = 0, cy = 0;  // [px]

  Eigen::Matrix3d matrix() const { return (Eigen::Matrix3d() << fx, 0, cx, 0, fy, cy, 0, 0, 1).finished(); }
};

/// fx fy cx cy k1 k2 p1 p2 k3, as in OpenCV.
template <class S = double>
struct Opencv5 : OpenCv5Intrinsics<S> {
  static constexpr std::string_view model_name = "opencv5";
  using OpenCv5Intrinsics<S>::OpenCv5Intrinsics;

  static Opencv5 fromPinhole(const Pinhole& p) { return {p.fx, p.fy, p.cx, p.cy, 0., 0., 0., 0., 0.}; }
  Eigen::Matrix3d cameraMatrix() const {
    return Pinhole{this->fx(), this->fy(), this->cx(), this->cy()}.matrix();
  }
  /// As OpenCV orders it: k1 k2 p1 p2 k3
  Eigen::VectorXd distortion() const { return this->template tail<5>(); }
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
};

template <class Camera>
inline constexpr bool has_denominator = false;
template <class S>
inline constexpr bool has_denominator<Opencv8<S>> = true;

/// fx fy cx cy k1 k2 k3 k4: OpenCV's fisheye, Kalibr's pinhole-equi.
template <class S = double>
struct Fisheye : FisheyeIntrinsics<S> {
  static constexpr std::string_view model_name = "fisheye";
  using FisheyeIntrinsics<S>::FisheyeIntrinsics;

  static Fisheye fromPinhole(const Pinhole& p) { return {p.fx, p.fy, p.cx, p.cy, 0., 0., 0., 0.}; }
  Eigen::Matrix3d cameraMatrix() const {
    return Pinhole{this->fx(), this->fy(), this->cx(), this->cy()}.matrix();
  }
  /// k1 k2 k3 k4
  Eigen::VectorXd distortion() const { return this->template tail<4>(); }
};

template <class Camera>
inline constexpr bool is_fisheye = false;
template <class S>
inline constexpr bool is_fisheye<Fisheye<S>> = true;

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
};

}  // namespace slom::app::calib
