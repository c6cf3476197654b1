#include "graph/settings.hpp"

#include <filesystem>

#include <fmt/format.h>

#include "error.hpp"
#include "output_files.hpp"

namespace slom::app::graph {

namespace {

RotationError parseRotationError(const std::string& text) {
  if (text == "vector") return RotationError::vector;
  if (text == "quaternion") return RotationError::quaternion;
  throw UserError(fmt::format("--rotation-error {}: unknown error; give vector or quaternion", text));
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

Settings parseSettings(const RawOptions& raw) {
  Settings settings = raw.rest;
  settings.fit = parseFitOptions(raw.fit);
  settings.init = parseStart(raw.init);
  settings.rotation_error = parseRotationError(raw.rotation_error);
  settings.online = parseOnline(raw.online);
  if (settings.online != Online::no && settings.init) {
    throw UserError(fmt::format(
        "--init {}: has no effect with --online, where each pose starts at the end of an edge from earlier "
        "poses; drop one of the two",
        raw.init));
  }
  checkPlot(settings.plot_file);
  checkResultPaths({{"FILE", settings.file}}, {{"--output", settings.output_file},
                                               {"--json", settings.report.jsonPath()},
                                               {"--plot", settings.plot_file}});
  return settings;
}

}  // namespace slom::app::graph
