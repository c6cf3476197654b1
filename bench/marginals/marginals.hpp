/// Marginal covariances for the benchmark's comparison.
#pragma once

#include <vector>

#include <Eigen/Core>

#include <slom/io/pose_graph.hpp>
#include <slom/io/scene.hpp>

namespace slom::bench {

struct Marginals {
  double seconds = 0;  ///< processor time from given values: derivatives to inversion
  /// The covariance of each pose or camera, in the tangent space of SLoM; empty for a fixed one.
  std::vector<Eigen::MatrixXd> blocks;
};

/// Standard deviation of a prior on each point of a scene, at its fitted value [units of the scene]. Some points are
/// seen along nearly one ray, and nothing else determines their distance.
inline constexpr double kPointSigma = 100;

/// Fits on one thread, writes the values back, and computes the marginals of all variables. Keeps the best of three
/// times.
template <class Pose>
Marginals marginalsBySlom(io::PoseGraph<Pose>& graph);
/// Computes marginals with camera 0 and point 0 fixed, because nothing else determines the place and scale of the
/// scene.
Marginals marginalsBySlom(io::Scene& scene);

#ifdef SLOM_BENCH_CERES
/// Computes the blocks of all poses by ceres::Covariance with SPARSE_QR on one thread, at the values of the graph.
template <class Pose>
Marginals marginalsByCeres(const io::PoseGraph<Pose>& graph);
/// Computes the blocks of all cameras, with camera 0 and point 0 fixed.
Marginals marginalsByCeres(const io::Scene& scene);
#endif

}  // namespace slom::bench
