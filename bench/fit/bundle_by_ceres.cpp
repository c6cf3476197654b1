// Bundle adjustment by Ceres, as in its example bundle_adjuster: a camera has 9 numbers, a point 3, and points are
// eliminated first.
#include <array>
#include <memory>

#include <Eigen/Geometry>
#include <ceres/ceres.h>

#include "fit/ceres_problem.hpp"
#include "fit/stopwatch.hpp"
#include "support/snavely_residual.hpp"

namespace slom::bench {

namespace {

class BundleProblem final : public CeresProblem {
 public:
  BundleProblem(const io::Scene& scene, double huber) : CeresProblem(huber) {
    for (const auto& camera : scene.cameras) {
      const Eigen::AngleAxisd turn(Eigen::Matrix3d(camera.pose.orient.toRotationMatrix()));
      const Eigen::Vector3d rotation = turn.angle() * turn.axis();
      cameras_.push_back({rotation[0], rotation[1], rotation[2], camera.pose.pos[0], camera.pose.pos[1],
                          camera.pose.pos[2], camera.lens.f(), camera.lens.k1(), camera.lens.k2()});
    }
    for (const auto& point : scene.points) points_.push_back({point[0], point[1], point[2]});
    for (const auto& seen : scene.observations) {
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<SnavelyResidual, 2, 9, 3>(
                                   new SnavelyResidual{seen.pixel[0], seen.pixel[1]}),
                               loss(), cameras_[static_cast<std::size_t>(seen.camera)].data(),
                               points_[static_cast<std::size_t>(seen.point)].data());
    }
    for (auto& point : points_) eliminated_first.push_back(point.data());
    for (const auto& camera : cameras_) blocks.push_back({camera.data()});
  }

 private:
  std::vector<std::array<double, 9>> cameras_;
  std::vector<std::array<double, 3>> points_;
};

}  // namespace

std::unique_ptr<CeresProblem> ceresProblemOf(const io::Scene& scene, double huber) {
  return std::make_unique<BundleProblem>(scene, huber);
}

Run fitByCeres(const io::Scene& scene, Schur schur, const Limits& limits) {
  std::unique_ptr<CeresProblem> problem;
  const double build = secondsOf([&] { problem = ceresProblemOf(scene, limits.huber); });
  const ceres::LinearSolverType solver = schur == Schur::dense    ? ceres::DENSE_SCHUR
                                         : schur == Schur::sparse ? ceres::SPARSE_SCHUR
                                                                  : ceres::ITERATIVE_SCHUR;
  Run run = solveByCeres(*problem, solver, limits);
  run.build_seconds = build;
  return run;
}

}  // namespace slom::bench
