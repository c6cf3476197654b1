/// One fit by one program, for the benchmark's comparison.
#pragma once

#include <string>
#include <vector>

#include <slom/io/pose_graph.hpp>
#include <slom/io/scene.hpp>
#include <slom/optimize/summary.hpp>

namespace slom::bench {

struct TracePoint {
  double seconds = 0;  ///< since the start of the fit, which follows building the problem
  double rss = 0;      ///< sum of squared whitened residuals, or the robust cost; no 1/2
};

struct Run {
  std::string solver;  ///< in the program's own words
  bool converged = false;
  int iterations = 0;
  double build_seconds = 0;      ///< inserting variables and measurements
  double seconds = 0;            ///< time of the fit, setup included
  double setup_seconds = 0;      ///< ordering, symbolic work, layout; for Ceres its preprocessor
  double iteration_seconds = 0;  ///< median of the iterations whose step was taken
  double linearize_seconds = 0;  ///< residuals, derivatives, normal equations, over all iterations
  double factor_seconds = 0;     ///< time of all factorisations; for Ceres, of its whole linear solver
  double solve_seconds = 0;      ///< with the factors
  int factorizations = 0;
  std::vector<TracePoint> trace;

  double finalRss() const { return trace.back().rss; }
  /// Returns the time at which the RSS first came within the fraction `tolerance` of `best`; NaN if it never did.
  double secondsUntil(double best, double tolerance) const;
};

struct Limits {
  int threads = 1;
  int max_iterations = 100;
  double huber = 0;  ///< scale of Huber's loss of all measurements [standard deviations]; 0: squares
};

/// Decrease of the RSS in an iteration, relative to the RSS, below which both programs stop. No other test stops them.
inline constexpr double kDecreaseTolerance = 1e-12;
inline constexpr double kOtherTolerances = 1e-16;

double median(std::vector<double> values);

Run runOf(const Summary& summary);

/// Fits by Gauss-Newton for pose graphs and Levenberg-Marquardt for bundles, as the commands do.
template <class Pose>
Run fitBySlom(const io::PoseGraph<Pose>& graph, const Limits& limits);
Run fitBySlom(const io::Scene& scene, const Limits& limits);

enum class Schur { dense, sparse, iterative };
#ifdef SLOM_BENCH_CERES
/// Fits by Levenberg-Marquardt with SPARSE_NORMAL_CHOLESKY of SuiteSparse. Derivatives are by Ceres' automatic
/// differentiation.
template <class Pose>
Run fitByCeres(const io::PoseGraph<Pose>& graph, const Limits& limits);
/// Fits by Levenberg-Marquardt with a Schur complement.
Run fitByCeres(const io::Scene& scene, Schur schur, const Limits& limits);
#endif

/// Cost of a factorisation of J^T J alone.
struct Factorization {
  double symbolic_seconds = 0;
  double numeric_seconds = 0;  ///< 0: not measured
  double flops = 0;            ///< additions and multiplications
};
/// Measures SLoM's symbolic work on the same structure: order, fronts, layout. Pivots are merged into larger fronts if
/// that is faster, so there are more operations than the sparsest factor needs.
template <class Pose>
Factorization analyzeBySlom(const io::PoseGraph<Pose>& graph);
#ifdef SLOM_BENCH_CHOLMOD
/// Measures the faster of CHOLMOD's simplicial and supernodal factorisations, each the best of several.
template <class Pose>
Factorization factorizeByCholmod(const io::PoseGraph<Pose>& graph);
#endif

}  // namespace slom::bench
