// What does a fit cost that follows its data?
//
//   bench_online FILE...      pose graphs of g2o or TORO
//
// Inserts the poses of each file in their order, with the edges to earlier ones, on one thread. After each pose comes update() or, in a
// second run for comparison, one optimizeStep() of the whole problem. Prints a line for each: wall-clock time in all, median, 99th percentile and worst of
// the steps, in milliseconds. Every hundredth step of update() is compared with the batch fit from the same values: the largest RSS /
// batch RSS - 1 must not be above twice the tolerance, or the program ends with status 1.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <variant>
#include <vector>

#include <slom/initialize/growing_map.hpp>
#include <slom/io.hpp>
#include <slom/slom.hpp>

namespace {

constexpr int kCompared = 100;  // steps from one comparison to the next
constexpr double kLeastRss = 1e-6;

struct Result {
  std::vector<double> milliseconds;  // time of each step
  double rss = 0, largest_gap = 0;
  int by_optimize = 0;
};

template <class Pose>
Result run(const slom::io::PoseGraph<Pose>& graph, bool updates) {
  slom::Estimator est;
  est.setThreads(1);
  slom::initialize::GrowingMap<slom::io::PoseGraph<Pose>, slom::io::PoseGraphModel> map(est, graph);
  const auto add = [&](int p) { map.add(p, map.startOf(p), p == 0); };
  add(0);
  Result result;
  for (int p = 1; p < static_cast<int>(graph.poses.size()); ++p) {
    const auto start = std::chrono::steady_clock::now();
    add(p);
    if (updates) {
      result.by_optimize += est.update().used_optimize ? 1 : 0;
    } else {
      est.optimizeStep();
    }
    const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;
    result.milliseconds.push_back(time.count());
    if (!updates || p % kCompared != 0) continue;
    slom::Estimator copy;
    map.copyTo(copy);
    const double batch = copy.optimize().final_rss;  // before a loop closes, rounding errors alone
    if (batch > kLeastRss) result.largest_gap = std::max(result.largest_gap, est.getRSS() / batch - 1);
  }
  result.rss = est.getRSS();
  return result;
}

double print(const std::string& file, const char* method, Result result) {
  std::vector<double>& times = result.milliseconds;
  double total = 0;
  for (const double t : times) total += t / 1000;
  std::sort(times.begin(), times.end());
  std::printf("| %s | %s | %.3f | %.3f | %.2f | %.2f | %.8g | %.1e | %d |\n", file.c_str(), method, total,
              times[times.size() / 2], times[times.size() * 99 / 100], times.back(), result.rss,
              result.largest_gap, result.by_optimize);
  std::fflush(stdout);
  return result.largest_gap;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: bench_online FILE...\n");
    return 2;
  }
  std::puts(
      "| file | after each pose | total [s] | median [ms] | 99 % | worst | RSS | largest gap | by optimize() |\n"
      "|---|---|---:|---:|---:|---:|---:|---:|---:|");
  double largest = 0;
  try {
    for (int i = 1; i < argc; ++i) {
      const std::string name = std::filesystem::path(argv[i]).stem().string();
      std::visit(
          [&](const auto& graph) {
            largest = std::max(largest, print(name, "update()", run(graph, true)));
            print(name, "optimizeStep()", run(graph, false));
          },
          slom::io::readPoseGraph(argv[i]));
    }
  } catch (const mtk::Error& error) {
    std::fprintf(stderr, "bench_online: %s\n", error.what());
    return 2;
  }
  return largest <= 2 * slom::UpdateOptions().tolerance ? 0 : 1;
}
