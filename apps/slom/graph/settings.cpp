#include "graph/settings.hpp"

#include <filesystem>

#include <fmt/format.h>

#include "error.hpp"
#include "fitting/fit_limits.hpp"
#include "fitting/progress.hpp"
#include "output_files.hpp"

namespace slom::app::graph {

namespace {

RotationError parseRotationError(const std::string& text) {
  if (text == "vector") return RotationError::vector;
  if (text == "quaternion") return RotationError::quaternion;
  throw UserError(fmt::format("--rotation-error {}: unknown error; give vector or quaternion", text));
}

/// Throws UserError if options name two starts.
void checkStart(const Settings& settings, const std::string& init) {
  const bool is_online = settings.online != Online::no;
  if (is_online && settings.init) {
    throw UserError(fmt::format(
        "--init {}: has no effect with --online, where each pose starts at the end of an edge from earlier "
        "poses; drop one of the two",
        init));
  }
  const CheckpointOptions& checkpoint = settings.checkpoint;
  if (!checkpoint.resume_from.empty() && settings.init && *settings.init != Start::given)
    throw UserError(fmt::format(
        "--init {}: has no effect with --resume, which starts at the checkpoint; drop one of the two", init));
  if (is_online && !(checkpoint.resume_from.empty() && checkpoint.write_to.empty()))
    throw UserError("--online: has no checkpoints; drop it, or drop --checkpoint and --resume");
}

void checkPlot(const std::string& file) {
  const std::string extension = std::filesystem::path(file).extension().string();
  if (file.empty() || extension == ".svg" || extension == ".html") return;
  throw UserError(
      fmt::format("--plot {}: unknown format; give FILE.svg (a picture) or FILE.html (a page on which to "
                  "turn it)",
                  file));
}

}  // namespace

Options optionsOf(const Settings& settings, const Console& console) {
  Options options;
  options.max_iterations = settings.fit.max_iterations;
  FitLimits::applyTo(options);
  options.deviation_tolerance = 1e-4;  // enough for a map
  options.observer = [&console](const IterationRecord& record) { console.print(iterationText(record)); };
  console.print("\n" + iterationHeader());
  return options;
}

Settings parseSettings(const RawOptions& raw) {
  Settings settings = raw.rest;
  settings.fit = parseFitOptions(raw.fit);
  checkCheckpointOptions(settings.checkpoint);
  settings.init = parseStart(raw.init);
  settings.rotation_error = parseRotationError(raw.rotation_error);
  settings.online = parseOnline(raw.online);
  checkStart(settings, raw.init);
  checkPlot(settings.plot_file);
  checkResultPaths({{"FILE", settings.file}}, {{"--output", settings.output_file},
                                               {"--json", settings.report.jsonPath()},
                                               {"--plot", settings.plot_file}});
  return settings;
}

}  // namespace slom::app::graph
