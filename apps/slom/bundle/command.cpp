// `slom bundle`: options, then read -> check -> fit -> report and files.
#include <memory>
#include <string>
#include <vector>

#include <slom/io/bal.hpp>

#include "bundle/bundle.hpp"
#include "bundle/check.hpp"
#include "bundle/checkpoint.hpp"
#include "bundle/fit/fit.hpp"
#include "bundle/output/output.hpp"
#include "bundle/output/report.hpp"
#include "bundle/processes/run.hpp"
#include "bundle/settings.hpp"
#include "fitting/checkpoints.hpp"
#include "fitting/fit_limits.hpp"
#include "fitting/progress.hpp"
#include "fitting/result_files.hpp"
#include "fitting/words.hpp"
#include "help.hpp"
#include "processes.hpp"

namespace slom::app {
namespace bundle {
namespace {

constexpr const char* help_text =
    R"(slom bundle problem.txt --output fitted.txt --output fitted.ply --json result.json

Fit cameras and points to images, from a BAL file (bundle adjustment).
Each camera has a pose, a focal length and two coefficients of radial distortion.
)";

Summary fit(Scene& scene, const SceneNumbers& numbers, const Settings& settings, io::Checkpoint& checkpoint,
            const Console& console, double& setup_seconds) {
  const Stopwatch setup;
  BundleFit fit(scene, settings.fit);
  setup_seconds = setup.seconds();
  const FitLimits limits(settings.fit.max_seconds);
  Options options = optionsOf(settings, console);
  CheckpointClock clock(settings.checkpoint, singleProcess(),
                        [&] { checkpoint.write(valuesOf(fit.cameras(), fit.points(), numbers)); });
  clock.follow(options);
  Summary summary = fit.optimize(options);
  clock.finish();
  FitLimits::nameIn(summary);
  putIntoWordsOfTheCommand(summary);
  fit.writeTo(scene);
  return summary;
}

/// Counts free directions at the end of the fit, even if it was cut short, unless counting takes long.
void countFreeDirections(const Scene& scene, RunReport& report) {
  const StopReason reason = report.summary.stop_reason;
  const bool was_cut_short = reason == StopReason::interrupted || reason == StopReason::time_limit;
  const FreeDirections free = bundle::countFreeDirections(scene, report.threads, !was_cut_short);
  report.free_directions = free.count;
  report.has_all_free_directions = free.is_exact;
  if (const std::string text = furtherText(free); !text.empty()) report.summary.warnings.push_back(text);
}

void writeFiles(const Scene& scene, const RunReport& report, const Settings& settings,
                const Console& console) {
  ResultFiles files(report, settings.report);
  for (const std::string& file : settings.output_files) files.add(file, [&] { return toText(scene, file); });
  files.finish(console);
}

void run(const RawOptions& raw) {
  const Stopwatch total;
  const Settings settings = parseSettings(raw);
  if (processCount() > 1 && run_on_processes != nullptr) return run_on_processes(settings, total);
  const Console console(settings.report);
  Scene scene = io::readScene(settings.file);
  const SceneNumbers numbers = SceneNumbers::ofWhole(scene);
  if (const std::string& from = settings.checkpoint.resume_from; !from.empty())
    takeValues(io::Checkpoint(from, problemOf(scene, numbers)), numbers, scene);
  const SceneCheck check = checkScene(scene, numbers);
  std::vector<std::string> results = settings.output_files;
  results.push_back(settings.report.jsonPath());
  requireWritable(results);
  io::Checkpoint checkpoint(settings.checkpoint.write_to, problemOf(scene, numbers));
  if (!settings.checkpoint.write_to.empty()) checkpoint.requireWritable();
  RunReport report;
  report.threads = threadsOf(settings.fit);
  report.warnings = check.warnings;
  const double rms_before = scene.rms();
  report.load_seconds = total.seconds();
  console.print(sceneText(scene.file, numbers, check));
  report.summary = fit(scene, numbers, settings, checkpoint, console, report.setup_seconds);
  report.total_seconds = total.seconds();
  countFreeDirections(scene, report);
  if (const std::string text = behindText(scene, numbers); !text.empty())
    report.summary.warnings.push_back(text);
  console.print(outcomeText(outcomeOf(report)) + rmsText(rms_before, scene.rms()));
  for (const std::string& warning : report.summary.warnings) console.print("  warning: " + warning + "\n");
  writeFiles(scene, report, settings, console);
  requireConverged(report, dominantText(scene, numbers));
}

}  // namespace
}  // namespace bundle

void addBundleCommand(CLI::App& app) {
  using namespace bundle;
  const auto raw = std::make_shared<RawOptions>();
  Settings& settings = raw->rest;
  CLI::App& command = *app.add_subcommand("bundle", help_text);
  command.footer(exit_codes);
  command.add_option("FILE", settings.file, "scene in BAL's format, plain or .bz2, or a container")
      ->required()
      ->type_name("");
  addFitOptions(command, raw->fit);
  command.get_option("--algorithm")
      ->description("lm: Levenberg-Marquardt; the others cannot hold the free directions");
  addLossOption(command, raw->fit);
  command
      .add_option("--tolerance", settings.tolerance,
                  "the fit has converged if the relative decrease of the RSS by a step is\nbelow this")
      ->type_name("NUMBER")
      ->capture_default_str();
  command
      .add_option("--output", settings.output_files,
                  "fitted scene in BAL's format, FILE.txt or FILE.bal, or cloud of points\n"
                  "and camera centres, FILE.ply; may be repeated")
      ->type_name("FILE")
      ->allow_extra_args(false);
  addReportOptions(command, settings.report);
  addCheckpointOptions(command, settings.checkpoint);
  command.callback([raw] { run(*raw); });
}

}  // namespace slom::app
