#include "slom/distributed/pose_graph.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <numeric>
#include <string_view>
#include <type_traits>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include <fmt/format.h>

#include "distributed/bytes.hpp"
#include "distributed/container.hpp"
#include "distributed/countable.hpp"
#include "distributed/division.hpp"
#include "distributed/index.hpp"
#include "distributed/messages.hpp"
#include "mtk/error.hpp"
#include "slom/io/container.hpp"
#include "slom/io/g2o.hpp"
#include "slom/io/numbered_lines.hpp"

namespace slom::distributed {

namespace {

using io::GraphLine;
using io::NumberedLines;
using Kind = GraphLine::Kind;

/// The lines of this process' part of the file, and where they go.
class Reader {
 public:
  Reader(const Processes& processes, const std::string& file) : processes_(processes), file_(file) {}

  AnyGraphPart read() {
    readOwnPart();
    Division division(processes_, idsOfVertices(), edges());
    division.learn(idsOf(lines_, false));
    const NumberedLines received = distribute(division);
    division.learn(idsOf(received, true));
    NumberedLines lines = withOtherVertices(received, division);
    lines.sort();
    return parse(lines, division);
  }

 private:
  void readOwnPart() {
    bool is_container = false;
    processes_.agree([&] { is_container = io::isContainer(file_); });
    if (is_container) {
      readOwnPartOfContainer();
    } else {
      readOwnPartOfText();
    }
    for (int i = 0; i < lines_.size(); ++i) kinds_.push_back(io::kindOfLine(lines_[i]));
    if (!processes_.any(lines_.size() > 0))
      throw mtk::Error("slom.io.empty-file",
                       file_ + ": the file is empty; a pose graph has a line for each edge", file_);
  }

  void readOwnPartOfContainer() {
    requireWhole(processes_, file_);
    processes_.agree(
        [&] { lines_ = io::readLinesOfPart(io::Container(file_), processes_.rank(), processes_.size()); });
    int last = 0;
    for (int i = 0; i < lines_.size(); ++i) last = std::max(last, lines_.number(i));
    line_count_ = std::int64_t(processes_.max(last));
  }

  void readOwnPartOfText() {
    int own_count = 0;
    processes_.agree([&] {
      io::PartOfFile part = io::readLinesOfPart(file_, processes_.rank(), processes_.size());
      lines_ = std::move(part.lines);
      own_count = part.line_count;
    });
    const std::vector<int> counts = gathered(processes_, std::vector<int>{own_count});
    line_count_ = std::accumulate(counts.begin(), counts.end(), std::int64_t{0});
    requireCountable(file_, line_count_, "lines", "give a smaller graph");
    lines_.shift(std::accumulate(counts.begin(), counts.begin() + processes_.rank(), 0));
  }

  std::vector<std::uint64_t> idsOfVertices() const {
    std::vector<std::uint64_t> ids;
    for (const GraphLine& line : kinds_) {
      if (line.kind == Kind::vertex) ids.push_back(line.id);
    }
    const bool has_vertices = processes_.any(!ids.empty());
    if (!has_vertices) {
      throw mtk::Error(
          "slom.io.no-vertices",
          file_ +
              ": the file has no vertices, which several processes need as start values; fit it in one "
              "process, or add vertices",
          file_);
    }
    return ids;
  }

  std::vector<Division::Edge> edges() const {
    std::vector<Division::Edge> edges;
    for (const GraphLine& line : kinds_) {
      if (line.kind == Kind::edge) edges.emplace_back(line.id, line.to);
    }
    return edges;
  }

  /// Returns the ids of the lines of vertices, edges, priors and fixed vertices. `with_ends`: also of the vertices that
  /// edges lead to.
  static std::vector<std::uint64_t> idsOf(const NumberedLines& lines, bool with_ends) {
    std::vector<std::uint64_t> ids;
    for (int i = 0; i < lines.size(); ++i) {
      const GraphLine line = io::kindOfLine(lines[i]);
      if (line.kind == Kind::fix) {
        forEachFixed(lines[i], [&](const std::string&, const GraphLine& one) {
          if (one.kind == Kind::fix) ids.push_back(one.id);
        });
      } else if (line.kind != Kind::sensor && line.kind != Kind::unknown) {
        ids.push_back(line.id);
      }
      if (with_ends && line.kind == Kind::edge) ids.push_back(line.to);
    }
    return ids;
  }

  /// Sends each line to the process that has its vertex, and returns those that arrive.
  NumberedLines distribute(const Division& division) {
    std::vector<NumberedLines> to_each(at(processes_.size()));
    for (int i = 0; i < lines_.size(); ++i) {
      const GraphLine& line = kinds_[at(i)];
      const auto send = [&](int process) { to_each[at(process)].add(lines_[i], lines_.number(i)); };
      if (line.kind == Kind::sensor) {
        for (int p = 0; p < processes_.size(); ++p) send(p);
      } else if (line.kind == Kind::fix) {
        sendFix(i, division, to_each);
      } else {
        send(line.kind == Kind::unknown ? processes_.rank() : division.processOf(line.id));
      }
    }
    lines_ = {};
    kinds_.clear();
    return exchanged(to_each);
  }

  /// Calls f(line, its kind) with `FIX i` for each word i of a line.
  template <class F>
  static void forEachFixed(std::string_view line, const F& f) {
    std::string_view rest = line.substr(3);
    for (;;) {
      const std::size_t first = rest.find_first_not_of(" \t\r");
      if (first == std::string_view::npos) return;
      const std::size_t end = std::min(rest.find_first_of(" \t\r", first), rest.size());
      const std::string one = "FIX " + std::string(rest.substr(first, end - first));
      f(one, io::kindOfLine(one));
      rest.remove_prefix(end);
    }
  }

  /// Sends `FIX i` for each id of the line; a line with anything else is refused here.
  void sendFix(int i, const Division& division, std::vector<NumberedLines>& to_each) {
    forEachFixed(lines_[i], [&](const std::string& one, const GraphLine& fix) {
      to_each[at(fix.kind == Kind::fix ? division.processOf(fix.id) : processes_.rank())].add(
          one, lines_.number(i));
    });
  }

  NumberedLines exchanged(const std::vector<NumberedLines>& to_each) const {
    std::vector<std::string> bytes;
    for (const NumberedLines& lines : to_each) bytes.push_back(lines.bytes());
    NumberedLines received;
    for (const std::string& part : processes_.exchange(bytes)) received.addBytes(part);
    return received;
  }

  /// Adds the lines of vertices of other processes that edges lead to.
  NumberedLines withOtherVertices(NumberedLines lines, const Division& division) {
    std::unordered_map<std::uint64_t, std::vector<int>> own;  // lines of own vertices
    std::vector<std::unordered_set<std::uint64_t>> wanted(at(processes_.size()));
    for (int i = 0; i < lines.size(); ++i) {
      const GraphLine line = io::kindOfLine(lines[i]);
      if (line.kind == Kind::vertex || line.kind == Kind::fix) own[line.id].push_back(i);
      if (line.kind != Kind::edge) continue;
      const int owner = division.processOf(line.to);
      if (owner != processes_.rank()) wanted[at(owner)].insert(line.to);
    }
    std::vector<std::string> requests;
    for (const auto& ids : wanted) {
      std::vector<std::uint64_t> sorted(ids.begin(), ids.end());
      std::sort(sorted.begin(), sorted.end());
      std::string& text = requests.emplace_back();
      for (const std::uint64_t id : sorted) append(text, id);
    }
    std::vector<NumberedLines> replies(at(processes_.size()));
    const std::vector<std::string> requested = processes_.exchange(requests);
    for (std::size_t p = 0; p < requested.size(); ++p) {
      for (const std::uint64_t id : valuesOf<std::uint64_t>(requested[p])) {
        lent_.insert(id);
        const auto found = own.find(id);
        if (found == own.end()) continue;
        for (const int i : found->second) replies[p].add(lines[i], lines.number(i));
      }
    }
    const NumberedLines others = exchanged(replies);
    lines.addBytes(others.bytes());
    return lines;
  }

  AnyGraphPart parse(const NumberedLines& lines, const Division& division) {
    io::AnyPoseGraph graph;
    bool is_empty = lines.size() == 0;
    processes_.agree([&] {
      requireVertices(lines);
      graph = io::parsePoseGraph(file_, lines);
      if (const auto* plane = std::get_if<io::PoseGraph<io::Pose2>>(&graph))
        is_empty = plane->poses.empty() && plane->landmarks.empty();
    });
    const bool in_space = processes_.any(std::holds_alternative<io::PoseGraph<io::Pose3>>(graph));
    processes_.agree([&] {
      if (!in_space || std::holds_alternative<io::PoseGraph<io::Pose3>>(graph)) return;
      if (!is_empty) {
        throw mtk::Error(
            "slom.io.bad-graph",
            file_ + ": some lines are of a graph in the plane, others of one in space; make two files",
            file_);
      }
      io::PoseGraph<io::Pose3> empty;
      empty.file = file_;
      empty.has_vertices = true;
      empty.sensors = {};
      graph = std::move(empty);
    });
    return std::visit([&](auto& any) -> AnyGraphPart { return partOf(std::move(any), division); }, graph);
  }

  /// Throws for edges if none of their vertices is there: the parser would make vertices.
  void requireVertices(const NumberedLines& lines) const {
    for (int i = 0; i < lines.size(); ++i) {
      if (io::kindOfLine(lines[i]).kind == Kind::vertex) return;
    }
    for (int i = 0; i < lines.size(); ++i) {
      const GraphLine line = io::kindOfLine(lines[i]);
      if (line.kind != Kind::edge && line.kind != Kind::prior) continue;
      const std::string place = fmt::format("{}:{}", file_, lines.number(i));
      throw mtk::Error(
          "slom.io.bad-graph",
          fmt::format("{}: there is no vertex {}; add a line for it, or remove this one", place, line.id),
          place);
    }
  }

  template <class Pose>
  GraphPart<Pose> partOf(io::PoseGraph<Pose> graph, const Division& division) {
    GraphPart<Pose> part;
    const auto mark = [&](const auto& nodes, std::vector<char>& is_own, std::vector<char>& is_shared) {
      for (const auto& node : nodes) {
        is_own.push_back(division.processOf(node.id) == processes_.rank());
        is_shared.push_back(!is_own.back() || lent_.count(node.id) > 0);
      }
    };
    mark(graph.poses, part.own_poses, part.shared_poses);
    mark(graph.landmarks, part.own_landmarks, part.shared_landmarks);
    part.graph = std::move(graph);
    part.line_count = line_count_;
    struct First {
      std::uint64_t id = 0;
      int line = std::numeric_limits<int>::max();
    } first;
    for (const auto& pose : part.graph.poses) {
      if (pose.line < first.line) first = {pose.id, pose.line};
    }
    std::string bytes;
    append(bytes, first);
    for (const std::string& text : processes_.gather(bytes)) {
      const First other = valuesOf<First>(text).front();
      if (other.line < first.line) first = other;
    }
    part.first_pose = first.id;
    const auto total = [&](std::size_t count) { return std::int64_t(processes_.sum(double(count))); };
    const auto own = [](const std::vector<char>& is_own) {
      return std::size_t(std::count(is_own.begin(), is_own.end(), 1));
    };
    part.poses = total(own(part.own_poses));
    part.landmarks = total(own(part.own_landmarks));
    part.edges = total(part.graph.edges.size());
    part.sightings = total(part.graph.sightings.size());
    part.bearings = total(part.graph.bearings.size());
    part.priors = total(part.graph.pose_priors.size() + part.graph.position_priors.size());
    part.has_priors = part.priors > 0;
    part.has_fix_lines = processes_.any(part.graph.has_fix_lines);
    constexpr std::int64_t dof = Pose::DOF;
    requireCountable(file_, dof * (part.edges + part.priors) + dof / 2 * part.sightings + part.bearings,
                     "residuals", "give a smaller graph");
    if (part.edges + part.sightings + part.bearings + part.priors == 0) {
      throw mtk::Error(
          "slom.io.no-edges",
          file_ + ": the file has no edge; a pose graph has lines EDGE_SE2, EDGE_SE3:QUAT, EDGE2 or EDGE3",
          file_);
    }
    return part;
  }

  const Processes& processes_;
  const std::string& file_;
  NumberedLines lines_;
  std::vector<GraphLine> kinds_;
  std::int64_t line_count_ = 0;
  std::unordered_set<std::uint64_t> lent_;  // ids of own vertices that others have, too
};

}  // namespace

AnyGraphPart readPoseGraph(const Processes& processes, const std::string& file) {
  return Reader(processes, file).read();
}

namespace {

/// Sends values of nodes that were fitted here to all processes that have them.
template <class Value>
void takeValues(const Processes& processes, const std::vector<char>& is_fitted_here,
                const std::vector<char>& is_shared, std::vector<io::Node<Value>>& nodes) {
  struct Fitted {
    std::uint64_t id;
    Value value;
  };
  std::string bytes;
  const auto append_bytes = [&](const Fitted& fitted) {
    bytes.append(reinterpret_cast<const char*>(&fitted), sizeof fitted);
  };
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (is_shared[i] != 0 && is_fitted_here[i] != 0) append_bytes({nodes[i].id, nodes[i].value});
  }
  std::unordered_map<std::uint64_t, std::size_t> place;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (is_shared[i] != 0) place.emplace(nodes[i].id, i);
  }
  for (const std::string& part : processes.gather(bytes)) {
    for (std::size_t at = 0; at < part.size(); at += sizeof(Fitted)) {
      alignas(Fitted) char raw[sizeof(Fitted)];
      std::memcpy(raw, part.data() + at, sizeof(Fitted));
      const Fitted& fitted = *reinterpret_cast<const Fitted*>(raw);
      if (const auto found = place.find(fitted.id); found != place.end())
        nodes[found->second].value = fitted.value;
    }
  }
}

}  // namespace

/// The text of a graph as lines in sections, each with the line of the file that it stands for. Not in the unnamed
/// namespace, because lambdas of exported templates capture it.
class TextOfGraph {
 public:
  explicit TextOfGraph(const std::string& text) : text_(text) {}
  std::string_view next() {
    const std::size_t end = text_.find('\n', at_) + 1;
    const std::string_view line = std::string_view(text_).substr(at_, end - at_);
    at_ = end;
    return line;
  }
  std::size_t count() const { return std::size_t(std::count(text_.begin(), text_.end(), '\n')); }

 private:
  const std::string& text_;
  std::size_t at_ = 0;
};

/// Hands out lines of sensors, which all processes have, once.
void gatherSensorLines(const Processes& processes, TextOfGraph& lines, std::size_t count, const TextSink& f) {
  std::string own;
  for (std::size_t i = 0; i < count; ++i) own += lines.next();
  const std::vector<std::string> of_all = processes.gather(own);
  processes.agree([&] {
    if (processes.rank() > 0) return;
    std::unordered_set<std::string_view> written;
    for (const std::string& text : of_all) {
      TextOfGraph all(text);
      for (std::size_t i = all.count(); i > 0; --i) {
        const std::string_view line = all.next();
        if (written.emplace(line).second) f(line);
      }
    }
  });
}

template <class Pose>
void takeFittedValues(const Processes& processes, const std::vector<char>& is_pose_fitted_here,
                      const std::vector<char>& is_landmark_fitted_here, GraphPart<Pose>& part) {
  takeValues(processes, is_pose_fitted_here, part.shared_poses, part.graph.poses);
  takeValues(processes, is_landmark_fitted_here, part.shared_landmarks, part.graph.landmarks);
}

template <class Pose>
void gatherG2o(const Processes& processes, const GraphPart<Pose>& part, const TextSink& f) {
  const io::PoseGraph<Pose>& graph = part.graph;
  const std::string text = io::toG2o(graph);
  TextOfGraph lines(text);
  const auto fixed = [](const auto& nodes) {
    return std::size_t(
        std::count_if(nodes.begin(), nodes.end(), [](const auto& node) { return node.fixed; }));
  };
  const std::size_t measurements = graph.edges.size() + graph.sightings.size() + graph.bearings.size() +
                                   graph.pose_priors.size() + graph.position_priors.size();
  const std::size_t vertices = graph.poses.size() + graph.landmarks.size();
  const std::size_t first =
      lines.count() - measurements - vertices - fixed(graph.poses) - fixed(graph.landmarks);
  gatherSensorLines(processes, lines, first, f);
  // The lines of a list of nodes or measurements. Only some of the list may have a line here, or count here.
  const auto gather = [&](const auto& items, const auto& has_line, const auto& is_own) {
    std::vector<std::pair<int, std::string_view>> own;
    for (std::size_t i = 0; i < items.size(); ++i) {
      if (!has_line(i)) continue;
      const std::string_view line = lines.next();
      if (is_own(i)) own.emplace_back(items[i].line, line);
    }
    gatherInOrder(processes, part.line_count + 1,
                  {own.size(), [&](std::size_t i) { return std::int64_t(own[i].first); },
                   [&](std::size_t i, std::string& piece) { piece += own[i].second; }},
                  f);
  };
  const auto always = [](std::size_t) { return true; };
  const auto gatherNodes = [&](const auto& nodes, const std::vector<char>& is_own, bool only_fixed) {
    gather(
        nodes, [&](std::size_t i) { return !only_fixed || nodes[i].fixed; },
        [&](std::size_t i) { return is_own[i] != 0; });
  };
  gatherNodes(graph.poses, part.own_poses, false);
  gatherNodes(graph.landmarks, part.own_landmarks, false);
  gatherNodes(graph.poses, part.own_poses, true);
  gatherNodes(graph.landmarks, part.own_landmarks, true);
  gather(graph.edges, always, always);
  gather(graph.sightings, always, always);
  gather(graph.bearings, always, always);
  gather(graph.pose_priors, always, always);
  gather(graph.position_priors, always, always);
}

// As in io::toG2o: a shared library hides instances of templates unless an attribute exports them.
template __attribute__((visibility("default"))) void takeFittedValues(const Processes&,
                                                                      const std::vector<char>&,
                                                                      const std::vector<char>&,
                                                                      GraphPart<io::Pose2>&);
template __attribute__((visibility("default"))) void takeFittedValues(const Processes&,
                                                                      const std::vector<char>&,
                                                                      const std::vector<char>&,
                                                                      GraphPart<io::Pose3>&);
template __attribute__((visibility("default"))) void gatherG2o(const Processes&, const GraphPart<io::Pose2>&,
                                                               const TextSink&);
template __attribute__((visibility("default"))) void gatherG2o(const Processes&, const GraphPart<io::Pose3>&,
                                                               const TextSink&);

}  // namespace slom::distributed
