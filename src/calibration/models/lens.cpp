#include "calibration/models/lens.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <fmt/format.h>

#include "calibration/models/definition.hpp"
#include "slom/calibration/error.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {
namespace {

/// Returns two unit vectors orthogonal to a ray and to each other, as columns. They turn with the ray, except near
/// the y axis.
Eigen::Matrix<double, 3, 2> tangents(const vec3& ray) {
  Eigen::Matrix<double, 3, 2> T;
  const bool is_along_y = std::abs(ray.y()) > 0.95;
  T.col(0) = is_along_y ? Eigen::Vector3d(Eigen::Vector3d(ray).cross(Eigen::Vector3d(0, 0, 1)).normalized())
                        : Eigen::Vector3d(Eigen::Vector3d(0, 1, 0).cross(ray).normalized());
  T.col(1) = Eigen::Vector3d(ray).cross(Eigen::Vector3d(T.col(0)));
  return T;
}

/// Returns the scale of the image near the optical axis [px/rad].
double scaleOf(const Lens& lens) {
  return lens.differentiate(Eigen::Vector3d(0, 0, 1)).by_point.norm() / std::sqrt(2.0);
}

}  // namespace

Lens::Lens(const Model& model, const std::vector<double>& parameters)
    : vect(Eigen::Map<const Eigen::VectorXd>(parameters.data(), Eigen::Index(parameters.size()))),
      model_(model) {}

vec2 Lens::project(const vec3& point) const { return model_.definition().project(data(), point); }

Lens::Projection Lens::differentiate(const Eigen::Vector3d& point) const {
  Projection projection;
  model_.definition().differentiate(data(), point, projection);
  return projection;
}

std::optional<vec3> Lens::unproject(const vec2& pixel, vec3 ray) const {
  constexpr double longest_leg = 0.06;  // approximate limit [rad]
  constexpr int most_steps = 8;
  // Limit of z for rays of length 1: above 0 for a pinhole, near -1 for a model of angles.
  const double least_z = model_.definition().start_lens == StartLens::equidistant ? -0.99 : 1e-3;
  const double scale = scaleOf(*this);
  PointProjection at = differentiate(ray);
  const vec2 start = at.pixel;
  const int legs = 1 + int(std::min(100.0, (pixel - start).norm() / (longest_leg * scale)));
  for (int leg = 1; leg <= legs; ++leg) {
    const vec2 target(start + double(leg) / legs * (pixel - start));
    double error = 0;
    for (int step = 0; step < most_steps; ++step) {
      const Eigen::Vector2d missing = target - at.pixel;
      error = missing.norm();
      if (error < 1e-7 || (leg < legs && error < 1e-2)) break;
      const Eigen::Matrix<double, 3, 2> T = tangents(ray);
      const Eigen::Matrix2d J = at.by_point * T;
      if (!(J.determinant() > 2e-4 * scale * scale)) return {};  // folds over, or is about to
      const Eigen::Vector2d angle = J.inverse() * missing;
      if (!(angle.norm() < 0.5)) return {};
      ray = vec3((ray + T * angle).normalized());
      if (!(ray.z() > least_z)) return {};
      at = differentiate(ray);
    }
    if (!(error < 1e-2)) return {};
  }
  return ray;
}

Lens lensOf(const CameraResult& camera) {
  if (camera.model.empty()) {
    throw DataError("slom.calibration.bad-camera",
                    fmt::format("camera {} has no model; pass a camera of the result of calibrate(), or "
                                "set model and parameters",
                                camera.name),
                    camera.name);
  }
  const Model model(camera.model);
  if (camera.parameters.size() != model.parameters().size()) {
    throw DataError(
        "slom.calibration.bad-camera",
        fmt::format("the number of parameters of camera {} is {} instead of {} for the model {}; set all "
                    "of them, in the order of Model::parameters()",
                    camera.name, camera.parameters.size(), model.parameters().size(), model.name()),
        camera.name);
  }
  std::vector<double> values;
  for (const Parameter& parameter : camera.parameters) values.push_back(parameter.value);
  return {model, values};
}

vec2 CameraResult::project(const vec3& point) const { return lensOf(*this).project(point); }
std::optional<vec3> CameraResult::ray(const vec2& pixel) const { return lensOf(*this).unproject(pixel); }

}  // namespace slom::calibration
