// The parts of a camera model. A model is a class template over its number type, a vector of named parameters, with
//   model_name, component_names       its name, the names of its parameters
//   fromPinhole(p)                    start values, from a pinhole without distortion; or startsFromPinhole(p), if a
//                                     fit may end in several minima: returns several starts, of which the best is kept
//   project(point)                    the pixel [px] of a point in the camera's frame; NaN if it has none
//   cameraMatrix(), distortion()      the pinhole that approximates it near the axis, and the other parameters
//   start_lens                        the lens that its start values assume
//   forOpencv(), forRos(), forKalibr()  its description in these programs, if they can describe it
// and optionally
//   differentiate(lens, point)        derivatives that are faster than those by dual numbers below
//   held_near_zero                    parameters of the prior Settings::sigma_denominator
//   is_compared                       false: compared only by name
#pragma once

#include <optional>
#include <string_view>
#include <type_traits>
#include <vector>

#include <slom/measurements/intrinsics.hpp>

#include "slom/calibration/models.hpp"
#include "slom/calibration/types.hpp"

namespace slom::calibration {

/// The camera that start values assume: a pinhole without distortion.
struct Pinhole {
  double fx = 0, fy = 0, cx = 0, cy = 0;  // [px]

  Eigen::Matrix3d matrix() const { return (Eigen::Matrix3d() << fx, 0, cx, 0, fy, cy, 0, 0, 1).finished(); }
};

/// The lens assumed until the fit: straight lines stay straight, or the distance from the image centre is f times the
/// angle to the axis.
enum class StartLens { pinhole, equidistant };

/// Returns the first `count` numbers of distortion(), with focal lengths and centre.
template <class Camera>
ForeignLens withPinhole(const Camera& camera, const char* distortion_model, int count) {
  const Eigen::Matrix3d K = camera.cameraMatrix();
  const Eigen::VectorXd d = camera.distortion().head(count);
  return {"pinhole", distortion_model, {K(0, 0), K(1, 1), K(0, 2), K(1, 2)}, {d.begin(), d.end()}};
}

/// A pixel and its derivatives; N: number of the lens parameters, in their order.
template <int N>
struct LensDerivatives {
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, N> by_parameters;
  Eigen::Matrix<double, 2, 3> by_point;  ///< [px/m]
};

/// Computes exact derivatives by dual numbers.
template <template <class> class Camera>
LensDerivatives<Camera<double>::DOF> differentiate(const Camera<double>& lens, const Eigen::Vector3d& point) {
  constexpr int n = Camera<double>::DOF;
  using S = mtk::Dual<double, n + 3>;
  Camera<S> camera;
  mtk::vect<3, S> p;
  for (int i = 0; i < n; ++i) camera[i].seed(lens[i], i);
  for (int i = 0; i < 3; ++i) p[i].seed(point[i], n + i);
  const mtk::vect<2, S> pixel = camera.project(p);
  LensDerivatives<n> d;
  for (int row = 0; row < 2; ++row) {
    d.pixel[row] = pixel[row].value();
    for (int i = 0; i < n; ++i) d.by_parameters(row, i) = pixel[row].partial(i);
    for (int i = 0; i < 3; ++i) d.by_point(row, i) = pixel[row].partial(n + i);
  }
  return d;
}

/// Returns derivatives of the projection, by the model's own function if it has one, whatever the order of includes.
template <class Camera>
auto derivativesOf(const Camera& lens, const Eigen::Vector3d& point) {
  return differentiate(lens, point);
}

}  // namespace slom::calibration
