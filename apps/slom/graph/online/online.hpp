// The map as it grows: pose after pose, with an update after each.
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

/// What --online asks for.
enum class Online {
  no,
  yes,   ///< update after each pose
  check  ///< and compare each hundredth update with the batch fit
};
/// "", "yes" or "check". Throws UserError.
Online parseOnline(const std::string& text);

struct Update {
  std::uint64_t pose = 0;  ///< id of the pose that came
  double seconds = 0;      ///< to insert it and to update
  UpdateSummary summary;
  double gap = 0;  ///< RSS / batch RSS - 1; NaN: not compared
};

/// One update after each pose.
struct OnlineRun {
  std::vector<Update> updates;
  std::vector<Sketch::Frame> frames;  ///< the map over time, after some of the updates
  double final_rss = 0;               ///< after the last update
  double batch_rss = 0;               ///< RSS of the batch fit from there; NaN: it did not come to its end
  std::size_t poses = 0;              ///< of the graph, fed or not

  /// Compares the last update with the batch fit.
  void finish(const Summary& batch);
  /// NaN where no update was compared: where all RSS were rounding errors.
  double largestGap() const;
};

/// A graph that was fed, in an estimator.
template <class Pose>
class OnlineFit {
 public:
  /// Feeds all poses of `graph`, which keeps its values, unless --max-seconds or Ctrl-C end that. `with_frames`: for a page.
  OnlineFit(const PoseGraph<Pose>& graph, const Gauge& gauge, const GraphModel& model, Online online,
            bool with_frames, const Console& console);
  ~OnlineFit();

  OnlineRun& run() { return run_; }
  /// Whether all poses were fed.
  bool isComplete() const { return run_.updates.size() == order().size(); }
  /// Indices of the poses in the order in which they are fed.
  const std::vector<int>& order() const;
  /// A batch fit from where the updates have led.
  Summary optimize(const Options& options) { return est_.optimize(options); }
  void writeTo(PoseGraph<Pose>& graph) const;

 private:
  struct Feed;
  Estimator est_;
  std::unique_ptr<Feed> feed_;
  OnlineRun run_;
};

/// Number, times and the largest gap, for people.
std::string onlineText(const OnlineRun& run);
/// "online" of the JSON.
nlohmann::ordered_json onlineJson(const OnlineRun& run);

}  // namespace slom::app::graph
