// Cost of a fit that follows its data.
//
//   bench_online [--json RESULT] FILE...      pose graphs of g2o or TORO, landmarks in the form of victoria_park.txt
//
// Inserts the poses of each file in their order, with the edges to earlier poses, on one thread. update() follows each
// pose. Further runs for comparison call one optimizeStep() of the whole problem after each pose and, for pose graphs,
// fit by Ceres after every tenth pose.
//
// Prints a line for each: total wall-clock time; median, 99th percentile and worst of the fits; and the worst fit at a
// loop closure. Every hundredth pose is compared with the batch fit from the same values. If the largest RSS / batch
// RSS - 1 of update() is above twice the tolerance, the program ends with status 1.
//
// The file with the results has the rest: times of reading values; of covariances of the newest pose after each fit; of
// all marginals after each of the last 100 fits, and computed anew at each hundredth pose. For small files it has the
// memory after one replay and after ten.
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <type_traits>
#include <variant>

#include <slom/io.hpp>
#include <slom/slom.hpp>

#include "online/output.hpp"

namespace {

using slom::bench::FileResult;

constexpr std::size_t kSmall = 2000;  // poses

int edgesOf(const auto& graph) { return static_cast<int>(graph.edges.size() + graph.sightings.size()); }

template <class Graph>
FileResult measure(const std::string& file, const Graph& graph) {
  FileResult result{.file = file,
                    .poses = static_cast<int>(graph.poses.size()),
                    .edges = edgesOf(graph),
                    .replays = {},
                    .memory = {}};
  if (graph.poses.size() <= kSmall) result.memory = slom::bench::memoryOfReplays(graph);  // before all else
  result.replays.push_back(slom::bench::replayByUpdate(graph));
  result.replays.push_back(slom::bench::replayBySteps(graph));
#ifdef SLOM_BENCH_CERES
  if constexpr (!std::is_same_v<Graph, slom::bench::LandmarkMap>)
    result.replays.push_back(slom::bench::replayByCeres(graph));
#endif
  return result;
}

/// Returns whether a file has odometry and landmarks in the form of victoria_park.txt.
bool hasLandmarks(const std::string& file) {
  std::ifstream lines(file);
  std::string word;
  return lines >> word && word == "ODOMETRY";
}

FileResult measureFile(const std::string& file) {
  const std::string name = std::filesystem::path(file).stem().string();
  if (hasLandmarks(file)) return measure(name, slom::testing::readVictoriaPark(file));
  return std::visit([&](const auto& graph) { return measure(name, graph); }, slom::io::readPoseGraph(file));
}

}  // namespace

int main(int argc, char** argv) {
  int first = 1;
  const char* json = nullptr;
  if (argc > 2 && std::strcmp(argv[1], "--json") == 0) {
    json = argv[2];
    first = 3;
  }
  if (first >= argc) {
    std::fprintf(stderr, "usage: bench_online [--json RESULT] FILE...\n");
    return 2;
  }
  std::vector<FileResult> results;
  double largest = 0;
  slom::bench::printHead();
  try {
    for (int i = first; i < argc; ++i) {
      results.push_back(measureFile(argv[i]));
      print(results.back());
      largest = std::max(largest, results.back().replays.front().largestGap());
    }
  } catch (const mtk::Error& error) {
    std::fprintf(stderr, "bench_online: %s\n", error.what());
    return 2;
  }
  if (json != nullptr) {
    std::ofstream file(json);
    slom::bench::writeJson(results, file);
    if (!file.flush()) {
      std::fprintf(stderr, "bench_online: cannot write %s; pass a path that can be written\n", json);
      return 2;
    }
  }
  return largest <= 2 * slom::UpdateOptions().tolerance ? 0 : 1;
}
