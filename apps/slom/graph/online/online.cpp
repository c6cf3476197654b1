#include "graph/online/online.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include <fmt/format.h>

#include <slom/initialize/growing_map.hpp>

#include "error.hpp"
#include "fitting/fit_limits.hpp"
#include "fitting/run_report.hpp"
#include "graph/online/feeding_order.hpp"

namespace slom::app::graph {

namespace {

constexpr std::size_t compared_each = 100;  // number of updates between comparisons
constexpr double least_rss = 1e-6;          // a smaller RSS is rounding error, as before a loop closes
constexpr std::size_t progress_lines = 20;
constexpr double most_places = 5e5, most_frames = 100;  // limits of a page

constexpr double not_compared = std::numeric_limits<double>::quiet_NaN();

double gapOf(double rss, double batch_rss) {
  return batch_rss > least_rss ? rss / batch_rss - 1 : not_compared;
}

/// Returns the number of updates between frames of a page, which limits the number of places of all frames together.
std::size_t updatesPerFrame(std::size_t poses) {
  const double frames = std::clamp(2 * most_places / double(poses), 8.0, most_frames);
  return std::max<std::size_t>(1, std::size_t(std::ceil(double(poses) / frames)));
}

std::string progressHeader() {
  return "\n    updates        pose            RSS   steps   moved   linearised   time/ms\n";
}

std::string progressText(std::size_t updates, const Update& update) {
  return fmt::format("  {:>9} {:>11} {:>14.8g} {:>7} {:>7} {:>12} {:>9.3g}{}\n", updates, update.pose,
                     update.summary.rss, update.summary.steps, update.summary.variables_moved,
                     update.summary.measurements_linearized, 1000 * update.seconds,
                     update.summary.used_optimize ? "   the batch fit took over" : "");
}

}  // namespace

Online parseOnline(const std::string& text) {
  if (text.empty()) return Online::no;
  if (text == "yes") return Online::yes;
  if (text == "check") return Online::check;
  throw UserError(
      fmt::format("--online={}: give --online, or --online=check, which compares with the batch fit", text));
}

void OnlineRun::finish(const Summary& batch) {
  batch_rss = batch.converged ? batch.final_rss : not_compared;
  if (!updates.empty()) updates.back().gap = gapOf(final_rss, batch_rss);
}

double OnlineRun::largestGap() const {
  double largest = not_compared;
  for (const Update& update : updates) largest = std::fmax(largest, update.gap);
  return largest;
}

template <class Pose>
struct OnlineFit<Pose>::Feed {
  using Map = initialize::GrowingMap<PoseGraph<Pose>, GraphModel>;

  Feed(Estimator& estimator, const PoseGraph<Pose>& graph_, const Gauge& gauge_, const GraphModel& model)
      : est(estimator), graph(graph_), gauge(gauge_), map(est, graph, model), order(feedingOrder(graph)) {}

  Update add(int p) {
    Update update{graph.poses[std::size_t(p)].id, 0, {}, not_compared};
    const Stopwatch stopwatch;
    map.add(p);
    gauge.hold(est, p, map.pose(p));
    update.summary = est.update();
    update.seconds = stopwatch.seconds();
    return update;
  }
  double batchRss() const {
    Estimator batch;
    const Map copy = map.copyTo(batch);
    for (const int p : order) {
      if (copy.pose(p).isValid()) gauge.hold(batch, p, copy.pose(p));
    }
    return batch.optimize().final_rss;
  }
  Sketch::Frame frame(std::size_t updates) const {
    Sketch::Frame frame;
    frame.pose = graph.poses[std::size_t(order[updates - 1])].id;
    for (std::size_t k = 0; k < updates; ++k) frame.poses.push_back(placeOf(map.pose(order[k])->pos));
    for (int l = 0; l < int(graph.landmarks.size()); ++l) {
      if (map.landmark(l).isValid()) frame.landmarks.push_back(placeOf(*map.landmark(l)));
    }
    return frame;
  }

  Estimator& est;
  const PoseGraph<Pose>& graph;
  const Gauge& gauge;
  Map map;
  std::vector<int> order;
};

template <class Pose>
OnlineFit<Pose>::OnlineFit(const PoseGraph<Pose>& graph, const Gauge& gauge, const GraphModel& model,
                           Online online, bool with_frames, const Console& console)
    : feed_(std::make_unique<Feed>(est_, graph, gauge, model)) {
  console.print(progressHeader());
  run_.poses = graph.poses.size();
  const std::size_t all = run_.poses, per_line = std::max<std::size_t>(1, all / progress_lines);
  const std::size_t per_frame = updatesPerFrame(all);
  for (std::size_t k = 1; k <= all && FitLimits::reasonToEnd().empty(); ++k) {
    Update update = feed_->add(feed_->order[k - 1]);
    if (online == Online::check && k % compared_each == 0)
      update.gap = gapOf(update.summary.rss, feed_->batchRss());
    run_.final_rss = update.summary.rss;
    if (k % per_line == 0 || k == all || update.summary.used_optimize) console.print(progressText(k, update));
    if (with_frames && (k % per_frame == 0 || k == all)) run_.frames.push_back(feed_->frame(k));
    run_.updates.push_back(std::move(update));
  }
}

template <class Pose>
OnlineFit<Pose>::~OnlineFit() = default;

template <class Pose>
const std::vector<int>& OnlineFit<Pose>::order() const {
  return feed_->order;
}

template <class Pose>
void OnlineFit<Pose>::writeTo(PoseGraph<Pose>& graph) const {
  feed_->map.writeTo(graph);
}

template class OnlineFit<Pose2>;
template class OnlineFit<Pose3>;

}  // namespace slom::app::graph
