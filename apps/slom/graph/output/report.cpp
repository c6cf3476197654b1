#include "graph/output/report.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "printable.hpp"
#include "text.hpp"

namespace slom::app::graph {

namespace {

template <class Value>
std::size_t fixedAmong(const std::vector<Node<Value>>& nodes) {
  return std::size_t(std::count_if(nodes.begin(), nodes.end(), [](const auto& node) { return node.fixed; }));
}

/// Returns `3, 5 and 7`; of many ids the first ones.
std::string shortList(const std::set<std::uint64_t>& ids) {
  constexpr std::size_t most = 5;
  std::vector<std::string> words;
  for (const std::uint64_t id : ids) {
    if (words.size() == most) break;
    words.push_back(std::to_string(id));
  }
  if (ids.size() > most) words.push_back(fmt::format("{} more", ids.size() - most));
  return listed(words, ", ", " and ");
}

template <class Pose>
std::string fixedText(const PoseGraph<Pose>& graph, const Gauge& gauge) {
  std::string text;
  if (graph.has_fix_lines) {
    const std::size_t poses = fixedAmong(graph.poses), landmarks = fixedAmong(graph.landmarks);
    if (poses > 0) text = plural(poses, "pose");
    if (landmarks > 0) text += (poses > 0 ? " and " : "") + plural(landmarks, "landmark");
    text += ", by lines FIX";
    if (!gauge.text.empty()) text += " and --hold-parts (" + gauge.text + ")";
  } else {
    text = gauge.text.empty() ? "nothing, because priors place the map"
                              : gauge.text + ", because there are no lines FIX";
  }
  if (!gauge.rotations_text.empty()) text += "; and " + gauge.rotations_text;
  return text;
}

/// Returns `chordal, with the lowest RSS among file, odometry and chordal`.
std::string startText(const std::optional<StartFound>& start) {
  if (!start) return "each pose at the end of an edge from earlier poses";
  const StartFound& found = *start;
  if (found.is_checkpoint) return "checkpoint";
  std::string text = optionOf(found.start);
  for (std::size_t i = 0; found.tried.size() > 1 && i < found.tried.size(); ++i) {
    text += i == 0 ? ", with the lowest RSS among " : i + 1 == found.tried.size() ? " and " : ", ";
    text += optionOf(found.tried[i]);
  }
  return text;
}

}  // namespace

template <class Pose>
std::vector<std::string> warningsOf(const PoseGraph<Pose>& graph) {
  std::vector<std::string> warnings = graph.unknown_tags.sentences();
  const std::set<std::uint64_t>& missing = graph.missing_sensors;
  if (missing.size() == 1) {
    warnings.push_back(fmt::format(
        "there is no line PARAMS_SE3OFFSET {}: this sensor is taken at the origin of the robot; add the line if it is elsewhere",
        *missing.begin()));
  } else if (!missing.empty()) {
    warnings.push_back(fmt::format(
        "there are no lines PARAMS_SE3OFFSET {}: these sensors are taken at the origin of the robot; add the lines if they are elsewhere",
        shortList(missing)));
  }
  return warnings;
}

template <class Pose>
std::string graphText(const PoseGraph<Pose>& graph, const Preparation& preparation) {
  std::string text =
      fmt::format("graph in {}, {}\n  {}, {}\n", dim<Pose> == 2 ? "the plane" : "space", oneLine(graph.file),
                  plural(graph.poses.size(), "pose"), plural(graph.edges.size(), "edge"));
  if (!graph.landmarks.empty()) {
    text += fmt::format("  {}, {}\n", plural(graph.landmarks.size(), "landmark"),
                        plural(graph.sightings.size(), "sighting"));
  }
  const std::size_t priors = graph.pose_priors.size() + graph.position_priors.size();
  if (!graph.bearings.empty()) text += "  " + plural(graph.bearings.size(), "bearing") + "\n";
  if (priors > 0) text += "  " + plural(priors, "prior") + "\n";
  text += fmt::format("  fixed: {}\n  start: {}\n", fixedText(graph, preparation.gauge),
                      startText(preparation.start));
  if (preparation.repaired > 0) {
    text += fmt::format("  repaired: {}\n", preparation.repaired == 1 ? "1 information matrix"
                                                                      : fmt::format("{} information matrices",
                                                                                    preparation.repaired));
  }
  for (const std::string& warning : warningsOf(graph)) text += fmt::format("  warning: {}\n", warning);
  return text;
}

template std::vector<std::string> warningsOf(const PoseGraph<Pose2>&);
template std::vector<std::string> warningsOf(const PoseGraph<Pose3>&);
template std::string graphText(const PoseGraph<Pose2>&, const Preparation&);
template std::string graphText(const PoseGraph<Pose3>&, const Preparation&);

}  // namespace slom::app::graph
