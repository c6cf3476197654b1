// Bundle adjustment by Ceres, as in its example bundle_adjuster: a camera of 9 numbers, a point of 3, points eliminated
// first.
#include <array>

#include <Eigen/Geometry>
#include <ceres/ceres.h>

#include "fit/ceres_problem.hpp"
#include "support/snavely_residual.hpp"

namespace slom::bench {

namespace {

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
          new ceres::AutoDiffCostFunction<SnavelyResidual, 2, 9, 3>(new SnavelyResidual{seen.pixel[0], seen.pixel[1]}), nullptr,
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
