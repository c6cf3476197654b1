/// Lenses: they map a point in the camera's frame (x right, y down, z forward) to a pixel (u right, v down).
///
/// A lens is a vector of named numbers, such as `intrinsics->fx()`. Its function `project(p)` takes p, 3 coordinates in
/// any unit, and returns the pixel [px]. To add a camera model, write one more such class template. Lenses are class
/// templates over their number type, so derivatives are exact and several points are projected at once.
///
/// If a point has no image, the result is NaN. So a step that moves a point behind its camera is undone. If start
/// values have such a point, an error names the measurement.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>

#include "mtk/preaccumulation.hpp"
#include "mtk/types/vect.hpp"

namespace slom {

namespace detail {
/// Returns the depth z if it is positive, otherwise NaN.
template <class S>
S depthInFront(const S& z) {
  using mtk::select;
  return select(z > 0.0, z, S(std::numeric_limits<double>::quiet_NaN()));
}

/// Returns coordinate I of a point. If the point's type allows, the result depends on that coordinate alone.
template <std::size_t I>
decltype(auto) coordinate(const auto& p) {
  if constexpr (requires { p.template get<I>(); }) {
    return p.template get<I>();
  } else {
    return p[I];
  }
}

/// N numbers that begin with the focal lengths and the image centre [px].
template <int N, class S>
struct CentredLens : mtk::vect<N, S> {
  static constexpr bool has_separate_entries = true;  ///< derivatives: entries are read only by get<I>()
  using mtk::vect<N, S>::vect;

  decltype(auto) fx() const { return this->template get<0>(); }
  decltype(auto) fy() const { return this->template get<1>(); }
  decltype(auto) cx() const { return this->template get<2>(); }
  decltype(auto) cy() const { return this->template get<3>(); }

 protected:
  /// Returns the pixel of a point in the image plane at depth 1.
  auto toPixels(const auto& x, const auto& y) const { return mtk::vector(fx() * x + cx(), fy() * y + cy()); }
};
}  // namespace detail

/// A lens without distortion: u = fx x/z + cx, v = fy y/z + cy. NaN for z <= 0.
template <class S = double>
struct PinholeIntrinsics : detail::CentredLens<4, S> {
  static constexpr std::array<std::string_view, 4> component_names{"fx", "fy", "cx", "cy"};
  using detail::CentredLens<4, S>::CentredLens;

  /// Returns the pixel of a point p in the camera's frame, 3 -> 2. Not finite for points without an image.
  auto project(const auto& p) const {
    return mtk::preaccumulate(p, [this](const auto& q) {
      const auto z = detail::depthInFront(detail::coordinate<2>(q));
      return this->toPixels(detail::coordinate<0>(q) / z, detail::coordinate<1>(q) / z);
    });
  }
};

/// A lens with radial and tangential distortion, in the order and meaning of OpenCV's 5 coefficients. NaN for z <= 0.
///   source   OpenCV 4 documentation, module calib3d, detailed description; Brown, "Close-range camera calibration",
///            1971
template <class S = double>
struct OpenCv5Intrinsics : detail::CentredLens<9, S> {
  static constexpr std::array<std::string_view, 9> component_names{"fx", "fy", "cx", "cy", "k1",
                                                                   "k2", "p1", "p2", "k3"};
  using detail::CentredLens<9, S>::CentredLens;

  decltype(auto) k1() const { return this->template get<4>(); }  ///< radial distortion, coefficient 1
  decltype(auto) k2() const { return this->template get<5>(); }  ///< radial distortion, coefficient 2
  decltype(auto) p1() const { return this->template get<6>(); }  ///< tangential distortion, coefficient 1
  decltype(auto) p2() const { return this->template get<7>(); }  ///< tangential distortion, coefficient 2
  decltype(auto) k3() const { return this->template get<8>(); }  ///< radial distortion, coefficient 3

  /// Returns the pixel of a point p in the camera's frame, 3 -> 2. Not finite for points without an image.
  auto project(const auto& p) const {
    return mtk::preaccumulate(p, [this](const auto& q) {
      const auto z = detail::depthInFront(detail::coordinate<2>(q));
      const auto x = detail::coordinate<0>(q) / z;
      const auto y = detail::coordinate<1>(q) / z;
      const auto xx = x * x;
      const auto yy = y * y;
      const auto xy2 = 2.0 * x * y;
      const auto r2 = xx + yy;
      const auto radial = 1.0 + r2 * (k1() + r2 * (k2() + r2 * k3()));
      return this->toPixels(x * radial + p1() * xy2 + p2() * (r2 + 2.0 * xx),
                            y * radial + p1() * (r2 + 2.0 * yy) + p2() * xy2);
    });
  }
};

/// Equidistant fisheye lens, OpenCV's `fisheye` without skew. The distance from the image centre is theta (1 + k1
/// theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8), theta the angle between the ray and the optical axis. Rays more
/// than 90 degrees off the axis (z <= 0) have an image too. OpenCV would mirror these rays; this lens follows the
/// angle. NaN on the axis behind the camera and in its centre.
///   source   OpenCV 4 documentation, namespace cv::fisheye; Kannala and Brandt, "A generic camera model and
///            calibration method for conventional, wide-angle, and fish-eye lenses", 2006, equation (6)
template <class S = double>
struct FisheyeIntrinsics : detail::CentredLens<8, S> {
  static constexpr std::array<std::string_view, 8> component_names{"fx", "fy", "cx", "cy",
                                                                   "k1", "k2", "k3", "k4"};
  using detail::CentredLens<8, S>::CentredLens;

  decltype(auto) k1() const { return this->template get<4>(); }  ///< radial distortion, coefficient 1
  decltype(auto) k2() const { return this->template get<5>(); }  ///< radial distortion, coefficient 2
  decltype(auto) k3() const { return this->template get<6>(); }  ///< radial distortion, coefficient 3
  decltype(auto) k4() const { return this->template get<7>(); }  ///< radial distortion, coefficient 4

  /// Returns the pixel of a point p in the camera's frame, 3 -> 2. Not finite for points without an image.
  auto project(const auto& p) const {
    return mtk::preaccumulate(p, [this](const auto& q) {
      const auto r2 = q[0] * q[0] + q[1] * q[1];
      const auto theta_by_r = angleByRadius(r2, q[2]);
      const auto t2 = theta_by_r * theta_by_r * r2;
      const auto scale = theta_by_r * (1.0 + t2 * (k1() + t2 * (k2() + t2 * (k3() + t2 * k4()))));
      return this->toPixels(scale * q[0], scale * q[1]);
    });
  }

 private:
  /// Returns atan2(r, z) / r. Near the axis it uses two terms of the series (1 - (r/z)^2 / 3 + ...) / z, which are
  /// exact there.
  template <class T>
  static T angleByRadius(const T& r2, const T& z) {
    using mtk::select;
    using std::atan2;
    using std::sqrt;
    const T z2 = z * z;
    const auto on_axis = z > 0.0 && r2 < 1e-15 * z2;
    const T r = sqrt(select(on_axis, T(1.0), r2));
    return select(on_axis, T((1.0 - r2 / (3.0 * z2)) / z), T(atan2(r, z) / r));
  }
};

/// The lens of "Bundle adjustment in the large": f [px], k1, k2, no image centre. This camera looks along -z, with y
/// upwards. With p = -(x, y) / z the pixel is f (1 + k1 |p|^2 + k2 |p|^4) p, from the image centre, v upwards. The
/// published model does not reject points behind the camera (z > 0): it gives them a mirrored image. For z = 0 the pixel
/// is not finite.
///   source   Agarwal, Snavely, Seitz, Szeliski, 2010, and the description of the data sets on the project's page
template <class S = double>
struct SnavelyIntrinsics : mtk::vect<3, S> {
  static constexpr bool has_separate_entries = true;
  static constexpr std::array<std::string_view, 3> component_names{"f", "k1", "k2"};
  using mtk::vect<3, S>::vect;

  decltype(auto) f() const { return this->template get<0>(); }   ///< focal length [px]
  decltype(auto) k1() const { return this->template get<1>(); }  ///< radial distortion, coefficient 1
  decltype(auto) k2() const { return this->template get<2>(); }  ///< radial distortion, coefficient 2

  /// Returns the pixel of a point p in the camera's frame, 3 -> 2. Not finite for points without an image.
  auto project(const auto& p) const {
    return mtk::preaccumulate(p, [this](const auto& q) {
      const auto x = -detail::coordinate<0>(q) / detail::coordinate<2>(q);
      const auto y = -detail::coordinate<1>(q) / detail::coordinate<2>(q);
      const auto r2 = x * x + y * y;
      const auto scale = f() * (1.0 + r2 * (k1() + r2 * k2()));
      return mtk::vector(scale * x, scale * y);
    });
  }
};

}  // namespace slom
