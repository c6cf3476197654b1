// `slom replay`: options, then load -> fit -> report and files.
#include <memory>
#include <sstream>
#include <string>

#include <fmt/format.h>

#include <slom/analyze/diagnosis.hpp>

#include "error.hpp"
#include "fitting/fit_limits.hpp"
#include "fitting/fit_options.hpp"
#include "fitting/progress.hpp"
#include "fitting/result_files.hpp"
#include "fitting/words.hpp"
#include "help.hpp"
#include "input_file.hpp"
#include "output_files.hpp"
#include "replay/kinds.hpp"
#include "replay/replay.hpp"

namespace slom::app {
namespace replay {
namespace {

constexpr const char* help_text =
    R"(slom replay problem.slom --diagnose --json result.json

Fit a problem that a program saved with slom::Archive.
Its measurements must be kinds of slom/measurements or traced. The output is that of the program,
with another algorithm or solver if you like. The file is text and may be edited.
)";

struct Settings {
  RawFitOptions fit;
  ReportOptions report;
  std::string file;
  std::string output_file;
  bool diagnose = false;
};

/// Returns f(). Errors of the library about a file or an option become UserError, without the id.
template <class F>
auto asUserError(const F& f) {
  try {
    return f();
  } catch (const mtk::Error& error) {
    throw UserError(inWordsOfTheCommand(std::string(error.sentence())));
  }
}

/// Shortens the list of known types in an error of the library to types of the same function.
std::string withoutList(const std::string& sentence) {
  const std::string unknown = " are not known to this program, which knows ";
  const std::size_t end = sentence.find(unknown), place = sentence.find(": ");
  if (end == std::string::npos || place > end) return sentence;
  const std::string type = sentence.substr(place + 2, end - place - 2);  // measurements "Range(...)"
  const std::size_t quote = type.find('"'), open = type.find('(');
  std::string others;
  if (quote != std::string::npos && open != std::string::npos) {
    const std::string function = type.substr(quote, open - quote + 1);  // "Range(
    for (std::size_t at = end; (at = sentence.find(function, at)) != std::string::npos; ++at)
      others += (others.empty() ? " but " : ", ") + sentence.substr(at, sentence.find('"', at + 1) + 1 - at);
  }
  return fmt::format("{}: slom replay does not know {}{}; fit this file with the program that saved it",
                     sentence.substr(0, place), type, others);
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
  StoredProblem problem = [&] {
    try {
      return archive.load(text, settings.file);
    } catch (const mtk::Error& error) {
      throw UserError(withoutList(std::string(error.sentence())));
    }
  }();
  requireWritable({settings.output_file, settings.report.jsonPath()});
  Estimator& est = problem.estimator;
  apply(fit, est);
  RunReport report;
  report.threads = threadsOf(fit);
  report.load_seconds = total.seconds();
  if (settings.diagnose) console.print(asUserError([&] { return slom::diagnose(est); }).text() + "\n");
  Options options;
  options.max_iterations = fit.max_iterations;
  options.observer = [&](const IterationRecord& record) { console.print(iterationText(record)); };
  console.print(iterationHeader());
  {
    const FitLimits limits(fit.max_seconds);
    FitLimits::applyTo(options);
    report.summary = asUserError([&] { return est.optimize(options); });
    FitLimits::nameIn(report.summary);
    putIntoWordsOfTheCommand(report.summary);
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
  requireConverged(report, "");
}

}  // namespace
}  // namespace replay

void addReplayCommand(CLI::App& app) {
  using namespace replay;
  const auto settings = std::make_shared<Settings>();
  CLI::App& command = *app.add_subcommand("replay", help_text);
  command.footer(exit_codes);
  command.add_option("FILE", settings->file, "problem saved by slom::Archive")->required()->type_name("");
  addFitOptions(command, settings->fit);
  command.add_flag("--diagnose", settings->diagnose,
                   "first print what is not determined or hardly determined");
  command.add_option("--output", settings->output_file, "problem with the fitted values")->type_name("FILE");
  addReportOptions(command, settings->report);
  command.callback([settings] { run(*settings); });
}

}  // namespace slom::app
