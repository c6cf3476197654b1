#include <algorithm>
#include <limits>
#include <memory>

#include <slom/io/pose_graph_model.hpp>
#include <slom/io/scene_model.hpp>
#include <slom/solve/block_solver.hpp>

#include "fit/stopwatch.hpp"
#include "marginals/marginals.hpp"

namespace slom::bench {

namespace {

/// Measures with a new solver each time, which must find its order again.
template <class T>
Marginals timedMarginals(Estimator& est, const std::vector<VarID<T>>& ids,
                         const std::vector<char>& is_fixed) {
  constexpr int repetitions = 3;
  Marginals result;
  result.seconds = std::numeric_limits<double>::infinity();
  std::unique_ptr<slom::Marginals> marginals;
  for (int i = 0; i < repetitions; ++i) {
    est.changeSolver(std::make_unique<BlockSolver>());
    const double seconds =
        processorSecondsOf([&] { marginals = std::make_unique<slom::Marginals>(est.marginals()); });
    result.seconds = std::min(result.seconds, seconds);
  }
  for (std::size_t i = 0; i < ids.size(); ++i) {
    result.blocks.push_back(is_fixed[i] ? Eigen::MatrixXd() : marginals->covariance(ids[i]));
  }
  return result;
}

}  // namespace

template <class Pose>
Marginals marginalsBySlom(io::PoseGraph<Pose>& graph) {
  Estimator est;
  est.setThreads(1);
  const io::PoseGraphVariables<Pose> ids = io::insert(est, graph);
  est.optimize({});
  ids.writeTo(graph);
  std::vector<char> is_fixed;
  for (const auto& pose : graph.poses) is_fixed.push_back(pose.fixed);
  return timedMarginals(est, ids.poses, is_fixed);
}
template Marginals marginalsBySlom(io::PoseGraph<io::Pose2>&);
template Marginals marginalsBySlom(io::PoseGraph<io::Pose3>&);

Marginals marginalsBySlom(io::Scene& scene) {
  Estimator est;
  est.setThreads(1);
  est.changeAlgorithm(LevenbergMarquardt(1e-4, 0.1));
  const io::SceneVariables ids = io::insert(est, scene);
  est.optimizeRV(ids.cameras[0], false);
  est.optimizeRV(ids.points[0], false);
  est.optimize({});
  ids.writeTo(scene);
  for (const auto& point : ids.points) {
    est.insertMeasurement([](const auto& p) { return p; }, point, measured(*point),
                          StandardDeviation(kPointSigma));
  }
  std::vector<char> is_fixed(scene.cameras.size(), 0);
  is_fixed[0] = 1;
  return timedMarginals(est, ids.cameras, is_fixed);
}

}  // namespace slom::bench
