// Bundle adjustment by Ceres, as in its example bundle_adjuster: a camera of 9 numbers, a point of 3, points eliminated
// first.
#include <array>

#include <Eigen/Geometry>
#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include "fit/ceres_problem.hpp"

namespace slom::bench {

namespace {

struct Reprojection {
  double u, v;

  template <class T>
  bool operator()(const T* camera, const T* point, T* residual) const {
    T p[3];
    ceres::AngleAxisRotatePoint(camera, point, p);
    for (int i = 0; i < 3; ++i) p[i] += camera[3 + i];
    const T x = -p[0] / p[2], y = -p[1] / p[2], r2 = x * x + y * y;
    const T scale = camera[6] * (1.0 + r2 * (camera[7] + r2 * camera[8]));
    residual[0] = scale * x - u;
    residual[1] = scale * y - v;
    return true;
  }
};

struct BundleProblem final : CeresProblem {
  explicit BundleProblem(const app::bundle::Scene& scene) {
    for (const auto& camera : scene.cameras) {
      const Eigen::AngleAxisd turn(Eigen::Matrix3d(camera.pose.orient.toRotationMatrix()));
      const Eigen::Vector3d rotation = turn.angle() * turn.axis();
      cameras.push_back({rotation[0], rotation[1], rotation[2], camera.pose.pos[0], camera.pose.pos[1], camera.pose.pos[2],
                         camera.lens.f(), camera.lens.k1(), camera.lens.k2()});
    }
    for (const auto& point : scene.points) points.push_back({point[0], point[1], point[2]});
    for (const auto& seen : scene.observations) {
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<Reprojection, 2, 9, 3>(new Reprojection{seen.pixel[0], seen.pixel[1]}), nullptr,
          cameras[static_cast<std::size_t>(seen.camera)].data(), points[static_cast<std::size_t>(seen.point)].data());
    }
  }
  std::vector<std::array<double, 9>> cameras;
  std::vector<std::array<double, 3>> points;
};

}  // namespace

Run fitByCeres(const app::bundle::Scene& scene, bool dense, const Limits& limits) {
  BundleProblem problem(scene);
  return solveByCeres(problem, dense ? ceres::DENSE_SCHUR : ceres::SPARSE_SCHUR, limits);
}

}  // namespace slom::bench
