// The map as it grows: pose by pose, with an update after each.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include <slom/estimator.hpp>

#include "fitting/console.hpp"
#include "graph/fit/held.hpp"
#include "graph/fit/model.hpp"
#include "graph/output/sketch.hpp"
#include "graph/pose_graph.hpp"

namespace slom::app::graph {

/// Modes of --online.
enum class Online {
  no,
  yes,   ///< update after each pose
  check  ///< and compare each hundredth update with the batch fit
};
/// Parses "", "yes" or "check". Throws UserError.
Online parseOnline(const std::string& text);

struct Update {
  std::uint64_t pose = 0;  ///< id of the added pose
  double seconds = 0;      ///< to insert it and to update
  UpdateSummary summary;
  double gap = 0;  ///< RSS / batch RSS - 1; NaN: not compared
};

/// A run with one update after each pose.
struct OnlineRun {
  std::vector<Update> updates;
  std::vector<Sketch::Frame> frames;  ///< the map over time, after some of the updates
  double final_rss = 0;               ///< after the last update
  double batch_rss = 0;               ///< RSS of the batch fit from there; NaN: it was not completed
  std::size_t poses = 0;              ///< of the graph, fed or not

  /// Compares the last update with the batch fit.
  void finish(const Summary& batch);
  /// Returns the largest gap; NaN if no update was compared, because every RSS was rounding error.
  double largestGap() const;
};

/// A graph that was fed to an estimator.
template <class Pose>
class OnlineFit {
 public:
  /// Feeds all poses of `graph`, whose values stay, unless --max-seconds or Ctrl-C ends it. `with_frames`: for a page.
  OnlineFit(const PoseGraph<Pose>& graph, const Gauge& gauge, const GraphModel& model, Online online,
            bool with_frames, const Console& console);
  ~OnlineFit();

  OnlineRun& run() { return run_; }
  /// Returns whether all poses were fed.
  bool isComplete() const { return run_.updates.size() == order().size(); }
  /// Returns the indices of the poses in the order in which they are fed.
  const std::vector<int>& order() const;
  /// Fits the whole graph from the values that the updates reached.
  Summary optimize(const Options& options) { return est_.optimize(options); }
  void writeTo(PoseGraph<Pose>& graph) const;

 private:
  struct Feed;
  Estimator est_;
  std::unique_ptr<Feed> feed_;
  OnlineRun run_;
};

/// Returns the number of updates, their times and the largest gap, as text.
std::string onlineText(const OnlineRun& run);
/// Returns "online" of the JSON.
nlohmann::ordered_json onlineJson(const OnlineRun& run);

}  // namespace slom::app::graph
