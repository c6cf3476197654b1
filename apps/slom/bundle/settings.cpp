#include "bundle/settings.hpp"

#include <filesystem>

#include <fmt/format.h>

#include "bundle/output/output.hpp"
#include "error.hpp"
#include "fitting/fit_limits.hpp"
#include "fitting/progress.hpp"
#include "output_files.hpp"

namespace slom::app::bundle {

namespace {

void checkAlgorithm(const NamedAlgorithm& algorithm) {
  if (algorithm.name == kAlgorithm) return;
  throw UserError(fmt::format(
      "--algorithm {}: cannot hold the free place, rotation and scale of a scene, as the damping of {} does; "
      "drop this option",
      algorithm.name, kAlgorithm));
}

void checkTolerance(double tolerance) {
  if (tolerance >= 0 && tolerance < 1) return;
  throw UserError(fmt::format("--tolerance {}: give a number from 0 on, and below 1", tolerance));
}

void checkOutput(const std::string& file) {
  if (formatOf(file) != Format::unknown) return;
  throw UserError(fmt::format(
      "--output {}: unknown format; give FILE.txt or FILE.bal (a scene in BAL's format) or FILE.ply (a cloud "
      "of points)",
      file));
}

}  // namespace

Options optionsOf(const Settings& settings, const Console& console) {
  Options options;
  options.max_iterations = settings.fit.max_iterations;
  FitLimits::applyTo(options);
  options.decrease_tolerance = settings.tolerance;
  options.deviation_tolerance =
      std::numeric_limits<double>::infinity();  // the standard deviation of a pixel is unknown
  options.observer = [&console](const IterationRecord& record) { console.print(iterationText(record)); };
  console.print("\n" + iterationHeader());
  return options;
}

Settings parseSettings(const RawOptions& raw) {
  Settings settings = raw.rest;
  settings.fit = parseFitOptions(raw.fit);
  checkCheckpointOptions(settings.checkpoint);
  checkAlgorithm(settings.fit.algorithm);
  checkTolerance(settings.tolerance);
  std::vector<NamedFile> results;
  for (const std::string& file : settings.output_files) {
    checkOutput(file);
    results.push_back({"--output", file});
  }
  results.push_back({"--json", settings.report.jsonPath()});
  checkResultPaths({{"FILE", settings.file}}, results);
  return settings;
}

}  // namespace slom::app::bundle
