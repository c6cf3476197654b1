// Memory left behind by replays.
#include <fstream>
#include <unistd.h>

#include "online/check.hpp"

namespace slom::bench {

namespace {
double residentBytes() {
  std::ifstream file("/proc/self/statm");
  double total = 0, resident = 0;
  file >> total >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

template <class Graph>
void replayOnce(const Graph& graph) {
  Estimator est;
  est.setThreads(1);
  Map<Graph> map(est, graph);
  for (int p = 0; p < static_cast<int>(graph.poses.size()); ++p) {
    map.add(p, map.startOf(p), p == 0);
    if (p > 0) est.update();
  }
}
}  // namespace

template <class Graph>
Memory memoryOfReplays(const Graph& graph) {
  Memory memory;
  for (int i = 0; i < memory.replays; ++i) {
    replayOnce(graph);
    if (i == 0) memory.after_one = residentBytes();
  }
  memory.after_all = residentBytes();
  return memory;
}

template Memory memoryOfReplays(const io::PoseGraph<io::Pose2>&);
template Memory memoryOfReplays(const io::PoseGraph<io::Pose3>&);
template Memory memoryOfReplays(const LandmarkMap&);

}  // namespace slom::bench
