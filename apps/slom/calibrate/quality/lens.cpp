#include "calibrate/quality/lens.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/LU>

#include "calibrate/fit/measurements.hpp"

namespace slom::app::calib {
namespace {

template <class Camera>
class ModelLens : public Lens {
 public:
  explicit ModelLens(const CameraResult& camera) {
    for (int i = 0; i < n; ++i) camera_[i] = camera.parameters[std::size_t(i)].value;
  }

  int parameters() const override { return n; }

  vec2 project(const vec3& point) const override { return vec2(camera_.project(point)); }

  Projection differentiate(const vec3& point) const override {
    const auto d = calib::differentiate(camera_, point);
    return {vec2(d.pixel), d.by_parameters, d.by_point};
  }

  Eigen::Matrix<double, 2, 3> byPoint(const vec3& point) const override {
    return calib::differentiate(camera_, point).by_point;
  }

  Eigen::MatrixXd jacobian(const SE3& left2camera, const SE3& left2world,
                           const std::vector<vec3>& points) const override {
    Eigen::MatrixXd J(2 * Eigen::Index(points.size()), n + 12);
    auto by_camera = J.leftCols<n>();
    auto by_left2world = J.middleCols<6>(n), by_left2camera = J.rightCols<6>();
    differentiatePixels(camera_, left2camera, left2world, points.size(), [&](std::size_t i) { return points[i]; },
                        &by_camera, &by_left2camera, &by_left2world);
    return J;
  }

 private:
  static constexpr int n = Camera::DOF;
  Camera camera_;
};

/// Two unit vectors orthogonal to a ray and to each other, as columns; they turn with the ray.
Eigen::Matrix<double, 3, 2> tangents(const vec3& ray) {
  Eigen::Matrix<double, 3, 2> T;
  T.col(0) = Eigen::Vector3d(0, 1, 0).cross(ray).normalized();
  T.col(1) = Eigen::Vector3d(ray).cross(Eigen::Vector3d(T.col(0)));
  return T;
}

}  // namespace

std::optional<vec3> Lens::unproject(const vec2& pixel, vec3 ray) const {
  constexpr double longest_leg = 0.06;  // of a walk [rad], about
  constexpr int most_steps = 8;
  const vec2 start = project(ray);
  const double scale = byPoint(vec3(0., 0., 1.)).norm() / std::sqrt(2.0);  // [px/rad]
  const int legs = 1 + int(std::min(100.0, (pixel - start).norm() / (longest_leg * scale)));
  for (int leg = 1; leg <= legs; ++leg) {
    const vec2 target(start + double(leg) / legs * (pixel - start));
    double error = 0;
    for (int step = 0; step < most_steps; ++step) {
      const Eigen::Vector2d missing = target - project(ray);
      error = missing.norm();
      if (error < 1e-7 || (leg < legs && error < 1e-2)) break;
      const Eigen::Matrix<double, 3, 2> T = tangents(ray);
      const Eigen::Matrix2d J = byPoint(ray) * T;
      if (!(J.determinant() > 2e-4 * scale * scale)) return {};  // folds over, or is about to
      const Eigen::Vector2d angle = J.inverse() * missing;
      if (!(angle.norm() < 0.5)) return {};
      ray = vec3((ray + T * angle).normalized());
      if (!(ray.z() > 1e-3)) return {};
    }
    if (!(error < 1e-2)) return {};
  }
  return ray;
}

std::unique_ptr<Lens> makeLens(const CameraResult& camera) {
  if (camera.model == Radial1<>::model_name) return std::make_unique<ModelLens<Radial1<>>>(camera);
  if (camera.model == Opencv4<>::model_name) return std::make_unique<ModelLens<Opencv4<>>>(camera);
  if (camera.model == Opencv5<>::model_name) return std::make_unique<ModelLens<Opencv5<>>>(camera);
  if (camera.model == Opencv8<>::model_name) return std::make_unique<ModelLens<Opencv8<>>>(camera);
  if (camera.model == Fisheye<>::model_name) return std::make_unique<ModelLens<Fisheye<>>>(camera);
  throw std::logic_error("slom calibrate: no lens of model " + camera.model);
}

}  // namespace slom::app::calib
