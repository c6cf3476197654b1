// `slom graph`: options, then read -> start -> fit -> report and files.
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <slom/analyze/diagnosis.hpp>
#include <slom/io/g2o.hpp>

#include "error.hpp"
#include "fitting/checkpoints.hpp"
#include "fitting/fit_limits.hpp"
#include "fitting/progress.hpp"
#include "fitting/result_files.hpp"
#include "fitting/words.hpp"
#include "graph/checkpoint.hpp"
#include "graph/fit/fit.hpp"
#include "graph/graph.hpp"
#include "graph/information.hpp"
#include "graph/initialization/gauge.hpp"
#include "graph/initialization/roots.hpp"
#include "graph/initialization/start.hpp"
#include "graph/online/online.hpp"
#include "graph/output/html.hpp"
#include "graph/output/report.hpp"
#include "graph/output/sketch.hpp"
#include "graph/output/svg.hpp"
#include "graph/processes/run.hpp"
#include "graph/settings.hpp"
#include "help.hpp"
#include "output_files.hpp"
#include "processes.hpp"

namespace slom::app {
namespace graph {
namespace {

constexpr const char* help_text =
    R"(slom graph map.g2o --output fitted.g2o --plot map.svg --json result.json

Fit a pose graph, the map of a robot, from a g2o or TORO file.
Poses and landmarks are in the plane or in space; edges have information matrices. If the file has
no lines FIX, the report says what is fixed. If it has no vertices, start values are found.
)";

template <class Pose>
io::Checkpoint checkpointIn(const std::string& folder, const PoseGraph<Pose>& graph) {
  return {folder, problemOf(graph, std::int64_t(graph.poses.size()), std::int64_t(graph.landmarks.size()),
                            std::int64_t(graph.edges.size()))};
}

/// Performs all steps between reading and fitting.
template <class Pose>
Preparation prepareOrThrow(PoseGraph<Pose>& graph, const Settings& settings) {
  Preparation preparation;
  preparation.repaired = checkInformation(graph, settings.repair_information);
  if (settings.online != Online::no &&
      !(graph.bearings.empty() && graph.pose_priors.empty() && graph.position_priors.empty())) {
    throw UserError("--online: " + graph.file +
                    " has bearings or priors, which cannot be fed pose by pose; leave the option out");
  }
  preparation.gauge = fixGauge(graph, settings.hold_parts);
  if (const std::string& from = settings.checkpoint.resume_from; !from.empty()) {
    takeValues(checkpointIn(from, graph), graph);
    graph.has_vertices = true;
    preparation.start.emplace().is_checkpoint = true;
  } else if (settings.online == Online::no) {
    preparation.start = findStart(graph, settings.init, settings.model());
  } else {
    const Roots<Pose> roots(graph);
  }
  return preparation;
}

/// Prepares the fit. Adds to errors which lines were skipped, because the missing data may be there.
template <class Pose>
Preparation prepare(PoseGraph<Pose>& graph, const Settings& settings) {
  try {
    return prepareOrThrow(graph, settings);
  } catch (const UserError& error) {
    const std::vector<std::string> skipped = graph.unknown_tags.sentences();
    if (skipped.empty()) throw;
    throw UserError(fmt::format("{} ({})", error.what(), fmt::join(skipped, ", ")));
  }
}

/// The map over time, if wanted, and the order in which its poses came; empty: not pose by pose.
struct Film {
  std::vector<Sketch::Frame> frames;
  std::vector<int> order;
};

/// Warns of directions that the measurements hardly determine, such as headings whose information was repaired. Fits
/// then converge slowly.
void warnOfWeakDirections(const Estimator& est, Summary& summary) {
  constexpr int most_unknowns = 30000;  // the diagnosis takes several factorisations
  constexpr std::size_t most_named = 3;
  if (summary.unknowns > most_unknowns) return;
  std::vector<std::string> weak;
  for (const Finding& finding : diagnose(est).findings) {
    if (finding.kind == Finding::Kind::weak) weak.push_back(finding.text);
  }
  if (weak.size() > most_named) {
    const std::size_t more = weak.size() - most_named;
    weak.resize(most_named);
    weak.push_back(
        fmt::format("{} hardly determined, too",
                    more == 1 ? "1 further direction is" : fmt::format("{} further directions are", more)));
  }
  summary.warnings.insert(summary.warnings.end(), weak.begin(), weak.end());
  if (!summary.converged && !weak.empty()) summary.message += ", while " + weak.front();
}

/// Returns whether a fit stopped without a reason in its data: at the iteration limit, or without progress.
bool hasCrept(const Summary& summary) {
  return summary.stop_reason == StopReason::max_iterations || summary.stop_reason == StopReason::no_progress;
}

template <class Pose>
Film fit(PoseGraph<Pose>& graph, const Gauge& gauge, const Settings& settings, const Console& console,
         RunReport& report) {
  const FitLimits limits(settings.fit.max_seconds);
  Film film;
  if (settings.online == Online::no) {
    const Stopwatch setup;
    GraphFit<Pose> fit(graph, gauge, settings.model());
    report.setup_seconds = setup.seconds();
    Options options = optionsOf(settings, console);
    io::Checkpoint checkpoint = checkpointIn(settings.checkpoint.write_to, graph);
    CheckpointClock clock(settings.checkpoint, singleProcess(),
                          [&] { checkpoint.write(valuesOf(graph, fit, [](const auto&) { return true; })); });
    clock.follow(options);
    report.summary = fit.optimize(options);
    clock.finish();
    if (hasCrept(report.summary) || settings.repair_information)
      warnOfWeakDirections(fit.estimator(), report.summary);
    fit.writeTo(graph);
  } else {
    OnlineFit<Pose> fit(graph, gauge, settings.model(), settings.online,
                        settings.plot_file.ends_with(".html"), console);
    report.summary = fit.optimize(optionsOf(settings, console));
    if (!fit.isComplete()) FitLimits::sayIn(report.summary);
    fit.run().finish(report.summary);
    console.print(onlineText(fit.run()));
    report.online = std::make_shared<nlohmann::ordered_json>(onlineJson(fit.run()));
    film = {std::move(fit.run().frames), fit.order()};
    fit.writeTo(graph);
  }
  FitLimits::nameIn(report.summary);
  putIntoWordsOfTheCommand(report.summary);
  return film;
}

template <class Pose>
void writeFiles(const PoseGraph<Pose>& graph, Film film, const RunReport& report, const Settings& settings,
                const Console& console) {
  ResultFiles files(report, settings.report);
  files.add(settings.output_file, [&] { return io::toG2o(graph); });
  files.add(settings.plot_file, [&] {
    Sketch sketch = sketchOf(graph, std::move(film.order));
    sketch.frames = std::move(film.frames);
    return settings.plot_file.ends_with(".svg") ? toSvg(sketch) : toHtml(sketch);
  });
  files.finish(console);
}

template <class Pose>
void run(PoseGraph<Pose> graph, const Settings& settings, const Stopwatch& total) {
  const Console console(settings.report);
  if (dim<Pose> == 3 && settings.plot_file.ends_with(".svg")) {
    throw UserError(fmt::format("--plot {}: this graph is in space; give FILE.html, a page to turn it on",
                                settings.plot_file));
  }
  if (const std::string& to = settings.checkpoint.write_to; !to.empty())
    checkpointIn(to, graph).requireWritable();
  const Preparation preparation = prepare(graph, settings);
  RunReport report;
  report.threads = threadsOf(settings.fit);
  report.warnings = warningsOf(graph);
  report.load_seconds = total.seconds();
  console.print(graphText(graph, preparation));
  Film film = fit(graph, preparation.gauge, settings, console, report);
  report.total_seconds = total.seconds();
  console.print(outcomeText(outcomeOf(report)));
  for (const std::string& warning : report.summary.warnings) console.print("  warning: " + warning + "\n");
  writeFiles(graph, std::move(film), report, settings, console);
  const StopReason reason = report.summary.stop_reason;
  const bool was_cut_short = reason == StopReason::interrupted || reason == StopReason::time_limit;
  const bool start_may_be_at_fault = settings.init && settings.init != Start::chordal && !was_cut_short &&
                                     reason != StopReason::rank_deficient;
  requireConverged(report, start_may_be_at_fault ? "; --init auto may find a better start" : "");
}

void run(const RawOptions& raw) {
  const Stopwatch total;
  const Settings settings = parseSettings(raw);
  if (processCount() > 1 && run_on_processes != nullptr) return run_on_processes(settings, total);
  io::AnyPoseGraph graph = io::readPoseGraph(settings.file);
  requireWritable({settings.output_file, settings.report.jsonPath(), settings.plot_file});
  std::visit([&](auto& any) { run(std::move(any), settings, total); }, graph);
}

}  // namespace
}  // namespace graph

void addGraphCommand(CLI::App& app) {
  using namespace graph;
  const auto raw = std::make_shared<RawOptions>();
  Settings& settings = raw->rest;
  CLI::App& command = *app.add_subcommand("graph", help_text);
  command.footer(exit_codes);
  command.add_option("FILE", settings.file, "graph in the format of g2o or TORO, or a container")
      ->required()
      ->type_name("");
  addFitOptions(command, raw->fit);
  addLossOption(command, raw->fit);
  command
      .add_option("--init", raw->init,
                  "where the fit starts; file: at the vertices; odometry: along edges\n"
                  "i, i+1; spanning-tree: along a breadth-first tree of edges; chordal:\n"
                  "at a chordal relaxation of all edges; build-up: after short fits that\n"
                  "add pose after pose; auto: where the RSS is lowest (build-up only for\n"
                  "graphs with landmarks)")
      ->type_name("auto|file|odometry|spanning-tree|chordal|build-up")
      ->capture_default_str();
  command
      .add_option("--rotation-error", raw->rotation_error,
                  "rotation error of edges in space: rotation vector, or vector part of\n"
                  "the quaternion as in g2o")
      ->type_name("vector|quaternion")
      ->capture_default_str();
  command.add_flag("--online{yes}", raw->online,
                   "feed the poses one by one by rising id and update the map after each;\n"
                   "--online=check also compares each 100th update with the batch fit");
  command.add_flag("--repair-information", settings.repair_information,
                   "use the nearest matrix if information is not positive definite");
  command.add_flag("--hold-parts", settings.hold_parts,
                   "fix the first vertex of each part without a fixed pose or landmark");
  command.add_option("--output", settings.output_file, "fitted graph in g2o's format")->type_name("FILE");
  command
      .add_option("--plot", settings.plot_file,
                  "drawing of the fitted graph: FILE.svg for graphs in the plane, or\n"
                  "FILE.html, a page on which to turn it")
      ->type_name("FILE");
  addReportOptions(command, settings.report);
  addCheckpointOptions(command, settings.checkpoint);
  command.callback([raw] { run(*raw); });
}

}  // namespace slom::app
