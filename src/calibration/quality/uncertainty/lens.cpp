#include "calibration/quality/uncertainty/lens.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <fmt/format.h>

#include "calibration/models/definition.hpp"
#include "slom/calibration/error.hpp"

namespace slom::calibration {
namespace {

/// Two unit vectors orthogonal to a ray and to each other, as columns; they turn with the ray, but for rays along y.
Eigen::Matrix<double, 3, 2> tangents(const vec3& ray) {
  Eigen::Matrix<double, 3, 2> T;
  const bool is_along_y = std::abs(ray.y()) > 0.95;
  T.col(0) = is_along_y ? Eigen::Vector3d(Eigen::Vector3d(ray).cross(Eigen::Vector3d(0, 0, 1)).normalized())
                        : Eigen::Vector3d(Eigen::Vector3d(0, 1, 0).cross(ray).normalized());
  T.col(1) = Eigen::Vector3d(ray).cross(Eigen::Vector3d(T.col(0)));
  return T;
}

}  // namespace

std::optional<vec3> Lens::unproject(const vec2& pixel, vec3 ray) const {
  constexpr double longest_leg = 0.06;  // approximate limit [rad]
  constexpr int most_steps = 8;
  PointProjection at = differentiateByPoint(ray);
  const vec2 start = at.pixel;
  const int legs = 1 + int(std::min(100.0, (pixel - start).norm() / (longest_leg * scale_)));
  for (int leg = 1; leg <= legs; ++leg) {
    const vec2 target(start + double(leg) / legs * (pixel - start));
    double error = 0;
    for (int step = 0; step < most_steps; ++step) {
      const Eigen::Vector2d missing = target - at.pixel;
      error = missing.norm();
      if (error < 1e-7 || (leg < legs && error < 1e-2)) break;
      const Eigen::Matrix<double, 3, 2> T = tangents(ray);
      const Eigen::Matrix2d J = at.by_point * T;
      if (!(J.determinant() > 2e-4 * scale_ * scale_)) return {};  // folds over, or is about to
      const Eigen::Vector2d angle = J.inverse() * missing;
      if (!(angle.norm() < 0.5)) return {};
      ray = vec3((ray + T * angle).normalized());
      if (!(ray.z() > least_z_)) return {};
      at = differentiateByPoint(ray);
    }
    if (!(error < 1e-2)) return {};
  }
  return ray;
}

std::unique_ptr<Lens> makeLens(const CameraResult& camera) {
  if (camera.model.empty()) {
    throw DataError("slom.calibration.bad-camera",
                    fmt::format("camera {} has no model; pass one of the result of calibrate(), or set model "
                                "and parameters",
                                camera.name),
                    camera.name);
  }
  const Model model(camera.model);
  if (camera.parameters.size() != model.parameters().size()) {
    throw DataError(
        "slom.calibration.bad-camera",
        fmt::format("camera {} has parameters: {} instead of the {} of the model {}; set all of them, in the "
                    "order of Model::parameters()",
                    camera.name, camera.parameters.size(), model.parameters().size(), model.name()),
        camera.name);
  }
  std::vector<double> values;
  for (const Parameter& parameter : camera.parameters) values.push_back(parameter.value);
  return model.definition().make_lens(values);
}

}  // namespace slom::calibration
