/// Marginal covariances, as the benchmark compares them.
#pragma once

#include <vector>

#include <Eigen/Core>

#include <slom/io/pose_graph.hpp>
#include <slom/io/scene.hpp>

namespace slom::bench {

struct Marginals {
  double seconds = 0;  ///< processor time, from the values: derivatives, order, factorisation, inversion
  /// The covariance of each pose or camera, in the tangent space of SLoM; empty for a fixed one.
  std::vector<Eigen::MatrixXd> blocks;
};

/// Standard deviation of a prior on each point of a scene, at its fitted value [units of the scene]: some points are seen along nearly
/// one ray, and nothing else determines their distance.
inline constexpr double kPointSigma = 100;

/// Fits on one thread, writes the values back, and computes the marginals of all variables. The best time of three.
template <class Pose>
Marginals marginalsBySlom(io::PoseGraph<Pose>& graph);
/// The same with camera 0 and point 0 fixed, as nothing else determines the place and scale of the scene.
Marginals marginalsBySlom(io::Scene& scene);

#ifdef SLOM_BENCH_CERES
/// ceres::Covariance by SPARSE_QR on one thread, at the values of the graph: the blocks of all poses.
template <class Pose>
Marginals marginalsByCeres(const io::PoseGraph<Pose>& graph);
/// The blocks of all cameras, with the same ones fixed.
Marginals marginalsByCeres(const io::Scene& scene);
#endif

}  // namespace slom::bench
