// `slom replay`: options, then load -> fit -> report and files.
#include <memory>
#include <sstream>
#include <string>

#include <fmt/format.h>

#include "error.hpp"
#include "fitting/fit_limits.hpp"
#include "fitting/fit_options.hpp"
#include "fitting/progress.hpp"
#include "fitting/result_files.hpp"
#include "input_file.hpp"
#include "output_files.hpp"
#include "replay/kinds.hpp"
#include "replay/replay.hpp"

namespace slom::app {
namespace replay {
namespace {

constexpr const char* help_text =
    R"(slom replay problem.slom --diagnose --json result.json

Fit a problem that a program saved with slom::Archive, when its measurements are those that SLoM has.
Shows what the program would have shown, with another algorithm or solver if you like; the file is text and may be edited.
)";

constexpr const char* footer_text =
    R"(Exit code: 0 success, 1 the fit did not converge or is not determined (the report says why),
or standard output could not be written, 2 wrong options or data.)";

struct Settings {
  RawFitOptions fit;
  ReportOptions report;
  std::string file;
  std::string output_file;
  bool diagnose = false;
};

/// What the library says of a file or an option that is wrong, without the id before it.
template <class F>
auto asUserError(const F& f) {
  try {
    return f();
  } catch (const mtk::Error& error) {
    throw UserError(std::string(error.sentence()));
  }
}

Archive makeArchive() {
  Archive archive;
  replay::addPoseKinds(archive);
  replay::addPriorKinds(archive);
  replay::addObservationKinds(archive);
  replay::addImageKinds(archive);
  return archive;
}

void run(const Settings& settings) {
  const Stopwatch total;
  const FitOptions fit = parseFitOptions(settings.fit);
  const Console console(settings.report);
  checkResultPaths({{"FILE", settings.file}},
                   {{"--output", settings.output_file}, {"--json", settings.report.jsonPath()}});
  const Archive archive = makeArchive();
  std::istringstream text(readWhole(settings.file));
  StoredProblem problem = asUserError([&] { return archive.load(text, settings.file); });
  requireWritable({settings.output_file, settings.report.jsonPath()});
  Estimator& est = problem.estimator;
  apply(fit, est);
  RunReport report;
  report.threads = threadsOf(fit);
  report.load_seconds = total.seconds();
  if (settings.diagnose) console.print(asUserError([&] { return est.diagnose(); }).text() + "\n");
  Options options;
  options.max_iterations = fit.max_iterations;
  options.observer = [&](const IterationRecord& record) { console.print(iterationText(record)); };
  console.print(iterationHeader());
  {
    const FitLimits limits(fit.max_seconds);
    FitLimits::applyTo(options);
    report.summary = asUserError([&] { return est.optimize(options); });
    FitLimits::nameIn(report.summary);
  }
  report.total_seconds = total.seconds();
  console.print("\n" + report.summary.report());
  ResultFiles files(report, settings.report);
  files.add(settings.output_file, [&] {
    std::ostringstream saved;
    archive.save(est, saved);
    return saved.str();
  });
  files.finish(console);
  requireConverged(report.summary, "");
}

}  // namespace
}  // namespace replay

void addReplayCommand(CLI::App& app) {
  using namespace replay;
  const auto settings = std::make_shared<Settings>();
  CLI::App& command = *app.add_subcommand("replay", help_text);
  command.footer(footer_text);
  command.add_option("FILE", settings->file, "the problem, as slom::Archive saves it")->required();
  addFitOptions(command, settings->fit);
  command.add_flag("--diagnose", settings->diagnose,
                   "say first what of the problem is not or hardly determined");
  command.add_option("--output", settings->output_file, "the problem with its fitted values")
      ->type_name("FILE");
  addReportOptions(command, settings->report);
  command.callback([settings] { run(*settings); });
}

}  // namespace slom::app
