/// A map fed pose by pose, and its cost.
#pragma once

#include <string>
#include <vector>

#include <slom/io/pose_graph.hpp>

#include "initialize/landmark_files.hpp"

namespace slom::bench {

/// The state of a replay at one step, compared with the batch optimum from the same values.
struct Check {
  int pose = 0;
  double gap = 0;             ///< RSS / batch RSS - 1
  double position_error = 0;  ///< root mean square distance to the positions of the batch optimum
  double marginals = 0;  ///< time of the covariances of all variables, computed anew [s]; 0: not measured
};

struct Replay {
  std::string method = {};
  /// Time of each fit, including the insertion before it. If a method does not fit at every pose, time of the fits it
  /// does.
  std::vector<double> seconds = {};
  double at_closures = 0;                       ///< the longest fit at a loop closure [s]
  double rss = 0;                               ///< at the end
  int by_optimize = 0;                          ///< calls that optimize() took over
  std::vector<double> covariance_seconds = {};  ///< of the newest pose, after each fit
  std::vector<double> marginals_seconds = {};   ///< of all variables, after each of the last fits
  double read_newest = 0, read_all = 0;         ///< total time of reading values, once after each fit [s]
  std::vector<Check> checks = {};

  double total() const;
  /// Returns the time that this fraction of the fits does not exceed [s].
  double quantile(double share) const;
  double largestGap() const;
  double largestPositionError() const;
};

/// Poses and landmarks in the plane.
using LandmarkMap = testing::Map<testing::Pose2>;

/// Calls update() after each pose; also reads values and covariances. Graph, here and below: io::PoseGraph<Pose> or
/// LandmarkMap.
template <class Graph>
Replay replayByUpdate(const Graph& graph);
/// Calls one optimizeStep() of everything after each pose.
template <class Graph>
Replay replayBySteps(const Graph& graph);
#ifdef SLOM_BENCH_CERES
/// Fits everything by Ceres from the last values after every tenth pose. Building its problem does not count.
template <class Pose>
Replay replayByCeres(const io::PoseGraph<Pose>& graph);
#endif

/// Resident memory after one replay by update() and after several, each in a new estimator, all in this process
/// [bytes].
struct Memory {
  double after_one = 0, after_all = 0;
  int replays = 10;
};
template <class Graph>
Memory memoryOfReplays(const Graph& graph);

}  // namespace slom::bench
