/// One fit by one program, as the benchmark compares them.
#pragma once

#include <string>
#include <vector>

#include <slom/optimize/summary.hpp>

#include "bundle/scene.hpp"
#include "graph/pose_graph.hpp"

namespace slom::bench {

struct TracePoint {
  double seconds = 0;  ///< since the start of the fit, the problem having been built before
  double rss = 0;      ///< sum of squared whitened residuals, no 1/2
};

struct Run {
  std::string program;
  int iterations = 0;
  double setup_seconds = 0;    ///< ordering, symbolic work, layout
  double seconds = 0;          ///< of the fit, setup included
  double factor_seconds = 0;   ///< of all numeric factorisations; for Ceres all of its linear solver
  std::vector<TracePoint> trace;
  std::string solver;

  double finalRss() const { return trace.back().rss; }
  /// Time of an iteration without what is done once.
  double secondsPerIteration() const { return iterations > 0 ? (seconds - setup_seconds) / iterations : 0; }
  /// When the RSS first came within the share `tolerance` of `best`; NaN when it never did.
  double secondsUntil(double best, double tolerance) const;
};

struct Limits {
  int threads = 1;
  int max_iterations = 100;
};

Run runOf(const Summary& summary);

/// Gauss-Newton for pose graphs, Levenberg-Marquardt for bundles, as the commands do it.
template <class Pose>
Run fitBySlom(const app::graph::PoseGraph<Pose>& graph, const Limits& limits);
Run fitBySlom(const app::bundle::Scene& scene, const Limits& limits);
#ifdef SLOM_BENCH_CERES
/// Levenberg-Marquardt with SPARSE_NORMAL_CHOLESKY by SuiteSparse, derivatives by Ceres' automatic differentiation.
template <class Pose>
Run fitByCeres(const app::graph::PoseGraph<Pose>& graph, const Limits& limits);
/// The same with DENSE_SCHUR or SPARSE_SCHUR.
Run fitByCeres(const app::bundle::Scene& scene, bool dense, const Limits& limits);
#endif

/// What CHOLMOD needs for the same matrix J^T J.
struct CholmodTimes {
  double symbolic_seconds = 0;
  double numeric_seconds = 0;
  double flops = 0;
};
#ifdef SLOM_BENCH_CHOLMOD
/// The faster of its simplicial and its supernodal factorisation, each the best of several.
template <class Pose>
CholmodTimes factorizeByCholmod(const app::graph::PoseGraph<Pose>& graph);
#endif

}  // namespace slom::bench
