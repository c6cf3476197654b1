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

#include <slom/io.hpp>
#include <slom/slom.hpp>

namespace {

constexpr int kCompared = 100;  // steps from one comparison to the next
constexpr double kLeastRss = 1e-6;

/// A graph that grows pose by pose.
template <class Pose>
class Feed {
 public:
  explicit Feed(const slom::io::PoseGraph<Pose>& graph) : graph_(graph), edges_of_(graph.poses.size()) {
    est.setThreads(1);
    for (const auto& edge : graph.edges)
      edges_of_[std::size_t(std::max(edge.from, edge.to))].push_back(&edge);
  }

  slom::Estimator est;

  std::size_t size() const { return graph_.poses.size(); }
  void insertNext() {
    const std::size_t i = ids_.size();
    ids_.push_back(est.insertRV(startOf(i), i > 0));
    for (const auto* edge : edges_of_[i])
      model_.insertEdge(est, ids_[std::size_t(edge->from)], ids_[std::size_t(edge->to)], *edge);
  }
  /// The RSS of the batch fit of what there is, from the values that it has now.
  double batchRss() const {
    slom::Estimator batch;
    std::vector<slom::VarID<Pose>> copies;
    for (std::size_t i = 0; i < ids_.size(); ++i) {
      copies.push_back(batch.insertRV(*ids_[i], i > 0));
      for (const auto* edge : edges_of_[i])
        model_.insertEdge(batch, copies[std::size_t(edge->from)], copies[std::size_t(edge->to)], *edge);
    }
    return batch.optimize().final_rss;
  }

 private:
  /// By the edge from the pose before or, without one, from any earlier one.
  Pose startOf(std::size_t i) const {
    Pose start = graph_.poses[i].value;
    for (const auto* edge : edges_of_[i]) {
      const int from = edge->from, to = edge->to, self = int(i);
      if (from == self && to == self) continue;
      start = to == self ? *ids_[std::size_t(from)] * edge->measured
                         : *ids_[std::size_t(to)] * edge->measured.inverse();
      if (std::min(from, to) == self - 1) break;
    }
    return start;
  }

  const slom::io::PoseGraph<Pose>& graph_;
  slom::io::PoseGraphModel model_;
  std::vector<std::vector<const slom::io::Edge<Pose>*>> edges_of_;
  std::vector<slom::VarID<Pose>> ids_;
};

struct Result {
  std::vector<double> milliseconds;  // of each step
  double rss = 0, largest_gap = 0;
  int by_optimize = 0;
};

template <class Pose>
Result run(const slom::io::PoseGraph<Pose>& graph, bool updates) {
  Feed<Pose> feed(graph);
  feed.insertNext();
  Result result;
  for (std::size_t i = 1; i < feed.size(); ++i) {
    const auto start = std::chrono::steady_clock::now();
    feed.insertNext();
    if (updates) {
      result.by_optimize += feed.est.update().used_optimize ? 1 : 0;
    } else {
      feed.est.optimizeStep();
    }
    const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;
    result.milliseconds.push_back(time.count());
    if (!updates || i % kCompared != 0) continue;
    const double batch = feed.batchRss();  // before a loop closes, rounding errors alone
    if (batch > kLeastRss) result.largest_gap = std::max(result.largest_gap, feed.est.getRSS() / batch - 1);
  }
  result.rss = feed.est.getRSS();
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
