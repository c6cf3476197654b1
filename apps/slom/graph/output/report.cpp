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

template <class Pose>
std::string fixedText(const PoseGraph<Pose>& graph, const std::string& fixed) {
  std::string text;
  if (graph.has_fix_lines) {
    text = plural(fixedAmong(graph.poses), "pose");
    if (const std::size_t landmarks = fixedAmong(graph.landmarks))
      text += " and " + plural(landmarks, "landmark");
    text += ", by lines FIX";
    if (!fixed.empty()) text += " and --hold-parts (" + fixed + ")";
  } else {
    text = fixed + ", as there are no lines FIX";
  }
  return text;
}

/// `chordal, of the lowest RSS among file, odometry and chordal`
std::string startText(const std::optional<StartFound>& start) {
  if (!start) return "each pose where an edge from those before it leads";
  const StartFound& found = *start;
  std::string text = optionOf(found.start);
  for (std::size_t i = 0; found.tried.size() > 1 && i < found.tried.size(); ++i) {
    text += i == 0 ? ", of the lowest RSS among " : i + 1 == found.tried.size() ? " and " : ", ";
    text += optionOf(found.tried[i]);
  }
  return text;
}

}  // namespace

template <class Pose>
std::string graphText(const PoseGraph<Pose>& graph, const Preparation& preparation) {
  std::string text =
      fmt::format("graph in {}, {}\n  {}, {}\n", dim<Pose> == 2 ? "the plane" : "space", oneLine(graph.file),
                  plural(graph.poses.size(), "pose"), plural(graph.edges.size(), "edge"));
  if (!graph.landmarks.empty()) {
    text += fmt::format("  {}, {}\n", plural(graph.landmarks.size(), "landmark"),
                        plural(graph.sightings.size(), "sighting"));
  }
  text += fmt::format("  fixed: {}\n  start: {}\n", fixedText(graph, preparation.fixed),
                      startText(preparation.start));
  if (preparation.repaired > 0) {
    text += fmt::format("  repaired: {}\n", preparation.repaired == 1 ? "1 information matrix"
                                                                      : fmt::format("{} information matrices",
                                                                                    preparation.repaired));
  }
  const io::UnknownTags& unknown = graph.unknown_tags;
  for (const auto& [tag, count] : unknown.lines)
    text += fmt::format("  warning: skipped {} with the unknown tag {}\n", plural(std::size_t(count), "line"),
                        tag);
  if (unknown.others > 0)
    text += fmt::format("  warning: skipped {} with other unknown tags\n",
                        plural(std::size_t(unknown.others), "line"));
  return text;
}

template std::string graphText(const PoseGraph<Pose2>&, const Preparation&);
template std::string graphText(const PoseGraph<Pose3>&, const Preparation&);

}  // namespace slom::app::graph
