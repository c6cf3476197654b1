#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <unordered_map>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include <slom/distributed.hpp>

#include "fitting/checkpoints.hpp"
#include "fitting/fit_limits.hpp"
#include "fitting/on_processes.hpp"
#include "fitting/progress.hpp"
#include "fitting/result_files.hpp"
#include "fitting/words.hpp"
#include "graph/checkpoint.hpp"
#include "graph/fit/fit.hpp"
#include "graph/information.hpp"
#include "graph/initialization/connected_vertices.hpp"
#include "graph/processes/run.hpp"
#include "output_files.hpp"
#include "text.hpp"

namespace slom::app::graph {

namespace {

using distributed::GraphPart;
using distributed::PetscSolver;
using distributed::Processes;

void requirePossible(const Settings& settings) {
  if (settings.online != Online::no) refuseOnProcesses("--online");
  if (settings.init && *settings.init != Start::given)
    refuseOnProcesses(std::string("--init ") + optionOf(*settings.init));
  if (settings.hold_parts) refuseOnProcesses("--hold-parts");
  if (!settings.plot_file.empty()) refuseOnProcesses("--plot");
  petscOptionsOf(settings.fit);
}

/// Fixes the first pose of the file, unless FIX lines or priors place the map. Returns what is fixed.
template <class Pose>
std::string fixGauge(GraphPart<Pose>& part) {
  if (part.has_fix_lines) return "what lines FIX name";
  if (part.has_priors) return "nothing, because priors place the map";
  for (auto& pose : part.graph.poses) pose.fixed = pose.fixed || pose.id == part.first_pose;
  return fmt::format("pose {}, because there are no lines FIX", part.first_pose);
}

/// Returns a line for each piece of this process' part that no measurement connects: its smallest id, whether it has a
/// fixed pose or a prior, and the ids that other processes have, too.
template <class Pose>
std::string piecesOf(const GraphPart<Pose>& part) {
  const auto& graph = part.graph;
  const std::size_t poses = graph.poses.size(), count = poses + graph.landmarks.size();
  DisjointSets nodes = connectedVertices(graph);
  std::vector<char> is_fixed(count, 0);
  for (const auto& prior : graph.pose_priors) is_fixed[std::size_t(prior.pose)] = 1;
  for (const auto& prior : graph.position_priors) is_fixed[std::size_t(prior.pose)] = 1;
  struct Piece {
    std::uint64_t first = std::numeric_limits<std::uint64_t>::max();
    bool is_fixed = false;
    std::string shared;
  };
  std::map<int, Piece> pieces;
  for (std::size_t i = 0; i < count; ++i) {
    const bool is_pose = i < poses;
    const std::uint64_t id = is_pose ? graph.poses[i].id : graph.landmarks[i - poses].id;
    Piece& piece = pieces[nodes.find(int(i))];
    piece.first = std::min(piece.first, id);
    piece.is_fixed = piece.is_fixed || is_fixed[i] != 0 ||
                     (is_pose ? graph.poses[i].fixed : graph.landmarks[i - poses].fixed);
    if ((is_pose ? part.shared_poses[i] : part.shared_landmarks[i - poses]) != 0)
      piece.shared += fmt::format(" {}", id);
  }
  std::string text;
  for (const auto& [root, piece] : pieces)
    text += fmt::format("{} {}{}\n", piece.first, piece.is_fixed ? 1 : 0, piece.shared);
  return text;
}

/// Throws UserError if the graph has parts without a fixed pose that no measurement connects with the others.
/// `of_processes`: piecesOf() of each.
void requireFixedParts(const std::vector<std::string>& of_processes, const std::string& file) {
  std::vector<std::uint64_t> first;
  std::vector<char> is_fixed;
  std::vector<std::pair<int, int>> joins;
  std::unordered_map<std::uint64_t, int> piece_with;
  for (const std::string& text : of_processes) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      std::istringstream words(line);
      std::uint64_t id = 0;
      int fixed = 0;
      words >> id >> fixed;
      const int own = int(first.size());
      first.push_back(id);
      is_fixed.push_back(char(fixed));
      while (words >> id) joins.emplace_back(own, piece_with.emplace(id, own).first->second);
    }
  }
  DisjointSets pieces(first.size());
  for (const auto& [a, b] : joins) pieces.join(a, b);
  std::map<int, std::pair<std::uint64_t, bool>> parts;
  for (std::size_t i = 0; i < first.size(); ++i) {
    auto& [smallest, has_fixed] =
        parts.emplace(pieces.find(int(i)), std::pair(first[i], false)).first->second;
    smallest = std::min(smallest, first[i]);
    has_fixed = has_fixed || is_fixed[i] != 0;
  }
  std::vector<std::uint64_t> open;
  for (const auto& [root, one] : parts) {
    if (!one.second) open.push_back(one.first);
  }
  if (open.empty()) return;
  throw UserError(fmt::format(
      "{}: the graph has {} parts that no edge connects, and {} no fixed pose: {} vertex {}; add edges between "
      "them, or a line FIX for a pose of each",
      file, parts.size(), open.size() == 1 ? "1 has" : fmt::format("{} have", open.size()),
      open.size() == 1 ? "the part of" : "the first is the part of",
      *std::min_element(open.begin(), open.end())));
}

/// Returns the skipped lines of all processes.
template <class Pose>
std::vector<std::string> skippedLines(const Processes& processes, const GraphPart<Pose>& part) {
  std::ostringstream own;
  for (const auto& [tag, count] : part.graph.unknown_tags.lines) own << tag << ' ' << count << '\n';
  io::UnknownTags all;
  for (const std::string& text : processes.gather(own.str())) {
    std::istringstream lines(text);
    std::string tag;
    for (int count = 0; lines >> tag >> count;) {
      for (; count > 0; --count) all.add(tag);
    }
  }
  all.others += int(processes.sum(part.graph.unknown_tags.others));
  return all.sentences();
}

template <class Pose>
std::string partText(const GraphPart<Pose>& part, const std::string& fixed, const std::string& start,
                     const RunReport& report) {
  const auto several = [](std::int64_t count, const char* noun) { return plural(std::size_t(count), noun); };
  std::string text =
      fmt::format("graph in {}, {}\n  {}, {}\n", dim<Pose> == 2 ? "the plane" : "space",
                  oneLine(part.graph.file), several(part.poses, "pose"), several(part.edges, "edge"));
  if (part.landmarks > 0)
    text +=
        fmt::format("  {}, {}\n", several(part.landmarks, "landmark"), several(part.sightings, "sighting"));
  if (part.bearings > 0) text += "  " + several(part.bearings, "bearing") + "\n";
  if (part.priors > 0) text += "  " + several(part.priors, "prior") + "\n";
  text += fmt::format("  fixed: {}\n  start: {}\n", fixed, start);
  for (const std::string& warning : report.warnings) text += fmt::format("  warning: {}\n", warning);
  return text;
}

/// Names the variables that other processes have, too.
template <class Pose>
distributed::SharedVariables sharedOf(const GraphPart<Pose>& part, GraphFit<Pose>& fit) {
  distributed::SharedVariables shared;
  const auto add = [&](const auto& nodes, const auto& variables, const auto& is_shared, const auto& is_own) {
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (is_shared[i] != 0) shared.share(fit.estimator(), variables[i], nodes[i].id, is_own[i] != 0);
    }
  };
  add(part.graph.poses, fit.poses(), part.shared_poses, part.own_poses);
  add(part.graph.landmarks, fit.landmarks(), part.shared_landmarks, part.own_landmarks);
  return shared;
}

template <class Variables>
std::vector<char> fittedHere(const PetscSolver& solver, const Variables& variables) {
  std::vector<char> result;
  for (const auto& id : variables) result.push_back(solver.isOwn(id) && solver.hasUnknowns(id) ? 1 : 0);
  return result;
}

template <class Pose>
distributed::Checkpoint checkpointIn(const std::string& folder, const Processes& processes,
                                     const GraphPart<Pose>& part) {
  return {processes, folder, problemOf(part.graph, part.poses, part.landmarks, part.edges)};
}

template <class Pose>
void run(const Processes& processes, GraphPart<Pose> part, const Settings& settings, const Stopwatch& total) {
  const ReportOptions report_options = onThisProcess(processes, settings.report);
  const Console console(report_options);
  RunReport report;
  processes.agree([&] { checkInformation(part.graph, settings.repair_information); });
  const std::string fixed = fixGauge(part);
  const std::vector<std::string> pieces = processes.gather(piecesOf(part));
  processes.agree([&] { requireFixedParts(pieces, part.graph.file); });
  if (!settings.checkpoint.resume_from.empty())
    takeValues(checkpointIn(settings.checkpoint.resume_from, processes, part), part.graph);
  distributed::Checkpoint checkpoint = checkpointIn(settings.checkpoint.write_to, processes, part);
  if (!settings.checkpoint.write_to.empty()) checkpoint.requireWritable();
  GraphModel model = settings.model();
  model.options = onThisProcess(model.options);
  report.threads = threadsOf(model.options);
  report.warnings = skippedLines(processes, part);
  report.load_seconds = total.seconds();
  console.print(
      partText(part, fixed, settings.checkpoint.resume_from.empty() ? "file" : "checkpoint", report));
  const FitLimits limits(settings.fit.max_seconds);
  const Stopwatch setup;
  std::unique_ptr<GraphFit<Pose>> fit;
  const PetscSolver* solver = nullptr;
  processes.agree([&] {
    fit = std::make_unique<GraphFit<Pose>>(part.graph, Gauge{}, model);
    auto petsc =
        std::make_unique<PetscSolver>(fit->estimator(), sharedOf(part, *fit), petscOptionsOf(settings.fit));
    solver = petsc.get();
    fit->estimator().changeSolver(std::move(petsc));
  });
  report.setup_seconds = setup.seconds();
  Options options = optionsOf(settings, console);
  CheckpointClock clock(settings.checkpoint, processes, [&] {
    checkpoint.write(valuesOf(part.graph, *fit,
                              [&](const auto& id) { return solver->isOwn(id) && solver->hasUnknowns(id); }));
  });
  clock.follow(options);
  report.summary = fit->optimize(options);
  clock.finish();
  FitLimits::nameIn(report.summary);
  putIntoWordsOfTheCommand(report.summary);
  fit->writeTo(part.graph);
  distributed::takeFittedValues(processes, fittedHere(*solver, fit->poses()),
                                fittedHere(*solver, fit->landmarks()), part);
  report.total_seconds = total.seconds();
  console.print(outcomeText(outcomeOf(report)) + fmt::format("  solver: {}\n", report.summary.solver) +
                processesText(processes));
  for (std::string& warning : unusedOptionsTexts()) report.summary.warnings.push_back(std::move(warning));
  for (const std::string& warning : report.summary.warnings) console.print("  warning: " + warning + "\n");
  ResultFiles files(report, report_options);
  writeInPieces(processes, files, settings.output_file,
                [&](const distributed::TextSink& f) { gatherG2o(processes, part, f); });
  processes.agree([&] {
    if (processes.rank() == 0) files.finish(console);
  });
  requireConvergedOnProcesses(processes, report, "");
}

}  // namespace

void runOnProcesses(const Settings& settings, const Stopwatch& total) {
  onProcesses([&](const Processes& processes) {
    processes.agree([&] { requirePossible(settings); });
    distributed::AnyGraphPart part = distributed::readPoseGraph(processes, settings.file);
    processes.agree([&] {
      if (processes.rank() == 0) requireWritable({settings.output_file, settings.report.jsonPath()});
    });
    std::visit([&](auto& any) { run(processes, std::move(any), settings, total); }, part);
  });
}

}  // namespace slom::app::graph
