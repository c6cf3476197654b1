// Maps fed pose by pose: update(), and for comparison one optimizeStep() of everything.
#include "fit/stopwatch.hpp"
#include "online/check.hpp"

namespace slom::bench {

namespace {

/// Adds the poses in their order, the first one fixed. Calls fit() after each further pose, and then after(p), untimed.
template <class Graph, class Fit, class After>
void feed(const Graph& graph, Map<Graph>& map, Replay& replay, const Fit& fit, const After& after) {
  map.add(0, map.startOf(0), true);
  for (int p = 1; p < static_cast<int>(graph.poses.size()); ++p) {
    bool has_closed = false;
    replay.seconds.push_back(secondsOf([&] {
      has_closed = map.add(p, map.startOf(p), false);
      fit();
    }));
    if (has_closed) replay.at_closures = std::max(replay.at_closures, replay.seconds.back());
    after(p);
  }
}

/// Number of last fits after which all marginals are computed.
constexpr int kWithMarginals = 100;

double traceOf(const Marginals& marginals, const auto& id) { return marginals.covariance(id).trace(); }

/// A sum that prevents the compiler from removing the reads.
volatile double read_sum = 0;

template <class Map>
void read(const Map& map, int newest, Replay& replay) {
  replay.read_newest += secondsOf([&] { read_sum = read_sum + map.pose(newest)->pos[0]; });
  replay.read_all += secondsOf([&] {
    double sum = 0;
    for (int p = 0; p <= newest; ++p) sum += map.pose(p)->pos[0];
    read_sum = read_sum + sum;
  });
}

}  // namespace

template <class Graph>
Replay replayByUpdate(const Graph& graph) {
  Estimator est;
  est.setThreads(1);
  Map<Graph> map(est, graph);
  Replay replay{.method = "update()"};
  const auto fit = [&] { replay.by_optimize += est.update().used_optimize ? 1 : 0; };
  feed(graph, map, replay, fit, [&](int p) {
    read(map, p, replay);
    replay.covariance_seconds.push_back(
        secondsOf([&] { read_sum = read_sum + est.updatedCovariance(map.pose(p))(0, 0); }));
    if (p + kWithMarginals >= static_cast<int>(graph.poses.size())) {
      const double seconds =
          secondsOf([&] { read_sum = read_sum + traceOf(est.updatedMarginals(), map.pose(p)); });
      replay.marginals_seconds.push_back(seconds);
    }
    if (p % kCompared != 0) return;
    replay.checks.push_back(compare<Graph>(est, map, p));
    replay.checks.back().marginals = secondsOf([&] { est.marginals(); });
  });
  replay.rss = est.getRSS();
  return replay;
}

template <class Graph>
Replay replayBySteps(const Graph& graph) {
  Estimator est;
  est.setThreads(1);
  Map<Graph> map(est, graph);
  Replay replay{.method = "optimizeStep()"};
  feed(
      graph, map, replay, [&] { est.optimizeStep(); },
      [&](int p) {
        if (p % kCompared == 0) replay.checks.push_back(compare<Graph>(est, map, p));
      });
  replay.rss = est.getRSS();
  return replay;
}

template Replay replayByUpdate(const io::PoseGraph<io::Pose2>&);
template Replay replayByUpdate(const io::PoseGraph<io::Pose3>&);
template Replay replayByUpdate(const LandmarkMap&);
template Replay replayBySteps(const io::PoseGraph<io::Pose2>&);
template Replay replayBySteps(const io::PoseGraph<io::Pose3>&);
template Replay replayBySteps(const LandmarkMap&);

}  // namespace slom::bench
