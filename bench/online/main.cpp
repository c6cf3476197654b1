// What does a fit cost that follows its data?
//
//   bench_online [--json RESULT] FILE...      pose graphs of g2o or TORO
//
// Inserts the poses of each file in their order, with the edges to earlier ones, on one thread. After each pose comes update(); in further
// runs for comparison one optimizeStep() of the whole problem, and after each tenth pose a fit by Ceres. Prints a line for each: wall-clock time in
// all, median, 99th percentile and worst of the fits, the worst where a loop closed. Every hundredth pose is compared with the batch fit
// from the same values: the largest RSS / batch RSS - 1 of update() must not be above twice the tolerance, or the program ends with
// status 1. The file with the results has the rest: times of reading values, of covariances of the newest pose after each fit and of all
// marginals at each hundredth pose, and for small files the memory after one replay and after ten.
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <variant>

#include <slom/io.hpp>
#include <slom/slom.hpp>

#include "online/output.hpp"

namespace {

using slom::bench::FileResult;

constexpr std::size_t kSmall = 2000;  // poses

template <class Pose>
FileResult measure(const std::string& file, const slom::io::PoseGraph<Pose>& graph) {
  FileResult result{.file = file,
                    .poses = static_cast<int>(graph.poses.size()),
                    .edges = static_cast<int>(graph.edges.size()),
                    .replays = {},
                    .memory = {}};
  if (graph.poses.size() <= kSmall) result.memory = slom::bench::memoryOfReplays(graph);  // before all else
  result.replays.push_back(slom::bench::replayByUpdate(graph));
  result.replays.push_back(slom::bench::replayBySteps(graph));
#ifdef SLOM_BENCH_CERES
  result.replays.push_back(slom::bench::replayByCeres(graph));
#endif
  return result;
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
      const std::string name = std::filesystem::path(argv[i]).stem().string();
      results.push_back(std::visit([&](const auto& graph) { return measure(name, graph); },
                                   slom::io::readPoseGraph(argv[i])));
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
