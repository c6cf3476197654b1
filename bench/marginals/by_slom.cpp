#include <algorithm>
#include <limits>
#include <memory>

#include <slom/solve/block_solver.hpp>

#include "bundle/fit/fit.hpp"
#include "fit/stopwatch.hpp"
#include "graph/fit/fit.hpp"
#include "marginals/marginals.hpp"

namespace slom::bench {

namespace {

/// Each time with a new solver, which has to find its order again.
template <class T>
Marginals timedMarginals(Estimator& est, const std::vector<VarID<T>>& ids, const std::vector<char>& is_held) {
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
    result.blocks.push_back(is_held[i] ? Eigen::MatrixXd() : marginals->covariance(ids[i]));
  }
  return result;
}

}  // namespace

template <class Pose>
Marginals marginalsBySlom(app::graph::PoseGraph<Pose>& graph) {
  app::graph::GraphModel model;
  model.options.threads = 1;
  app::graph::GraphFit<Pose> fit(graph, model);
  fit.optimize({});
  fit.writeTo(graph);
  std::vector<char> is_held;
  for (const auto& pose : graph.poses) is_held.push_back(pose.held);
  return timedMarginals(fit.estimator(), fit.poses(), is_held);
}
template Marginals marginalsBySlom(app::graph::PoseGraph<app::graph::Pose2>&);
template Marginals marginalsBySlom(app::graph::PoseGraph<app::graph::Pose3>&);

Marginals marginalsBySlom(app::bundle::Scene& scene) {
  app::FitOptions options;
  options.algorithm = app::AlgorithmName::lm;
  options.threads = 1;
  app::bundle::BundleFit fit(scene, options);
  fit.estimator().optimizeRV(fit.cameras()[0], false);
  fit.estimator().optimizeRV(fit.points()[0], false);
  fit.optimize({});
  fit.writeTo(scene);
  for (const auto& point : fit.points()) {
    fit.estimator().insertMeasurement([](const auto& p) { return p; }, point, measured(*point),
                                      StandardDeviation(kPointSigma));
  }
  std::vector<char> is_held(scene.cameras.size(), 0);
  is_held[0] = 1;
  return timedMarginals(fit.estimator(), fit.cameras(), is_held);
}

}  // namespace slom::bench
