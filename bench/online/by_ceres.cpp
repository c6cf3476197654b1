// Ceres for comparison: fits everything again from the last values, after every tenth pose.
#include <Eigen/Geometry>
#include <ceres/ceres.h>

#include "fit/ceres_problem.hpp"
#include "online/check.hpp"

namespace slom::bench {

namespace {

constexpr int kEachPose = 10;

/// Reads the pose that Ceres has in these blocks (see fit/graph_by_ceres.cpp).
void readPose(const std::vector<const double*>& blocks, io::Pose2& pose) {
  pose = io::Pose2({blocks[0][0], blocks[0][1]}, mtk::SO2<>(blocks[1][0]));
}
void readPose(const std::vector<const double*>& blocks, io::Pose3& pose) {
  const double *p = blocks[0], *q = blocks[1];  // x y z w
  const Eigen::Quaterniond turn(q[3], q[0], q[1], q[2]);
  pose = io::Pose3(mtk::SO3<>(turn.normalized()), {p[0], p[1], p[2]});
}

/// Returns the poses 0 to `last` at their present values, and the edges between them.
template <class Pose>
io::PoseGraph<Pose> partOf(const io::PoseGraph<Pose>& graph, const Map<io::PoseGraph<Pose>>& map, int last) {
  io::PoseGraph<Pose> part;
  part.poses.assign(graph.poses.begin(), graph.poses.begin() + last + 1);
  for (int p = 0; p <= last; ++p) {
    part.poses[static_cast<std::size_t>(p)].value = *map.pose(p);
    part.poses[static_cast<std::size_t>(p)].fixed = p == 0;
  }
  for (const auto& edge : graph.edges) {
    if (edge.from <= last && edge.to <= last) part.edges.push_back(edge);
  }
  return part;
}

}  // namespace

template <class Pose>
Replay replayByCeres(const io::PoseGraph<Pose>& graph) {
  Estimator est;  // holds the values
  Map<io::PoseGraph<Pose>> map(est, graph);
  Replay replay{.method = "Ceres, each 10th pose"};
  bool has_closed = false;  // true: a loop closed since the last fit
  const int last = static_cast<int>(graph.poses.size()) - 1;
  map.add(0, map.startOf(0), true);
  for (int p = 1; p <= last; ++p) {
    has_closed = map.add(p, map.startOf(p), false) || has_closed;
    if (p % kEachPose != 0 && p != last) continue;
    const auto problem = ceresProblemOf(partOf(graph, map, p), 0);
    replay.seconds.push_back(solveByCeres(*problem, ceres::SPARSE_NORMAL_CHOLESKY, {}).seconds);
    if (has_closed) replay.at_closures = std::max(replay.at_closures, replay.seconds.back());
    has_closed = false;
    for (int i = 1; i <= p; ++i) {
      Pose value = *map.pose(i);
      readPose(problem->blocks[static_cast<std::size_t>(i)], value);
      est.reinitRV(map.pose(i), value);
    }
    if (p % kCompared == 0) replay.checks.push_back(compare<io::PoseGraph<Pose>>(est, map, p));
  }
  replay.rss = est.getRSS();
  return replay;
}

template Replay replayByCeres(const io::PoseGraph<io::Pose2>&);
template Replay replayByCeres(const io::PoseGraph<io::Pose3>&);

}  // namespace slom::bench
