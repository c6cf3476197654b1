#include "bundle/settings.hpp"

#include <filesystem>

#include <fmt/format.h>

#include "bundle/output/output.hpp"
#include "error.hpp"
#include "output_files.hpp"

namespace slom::app::bundle {

namespace {

void checkAlgorithm(const NamedAlgorithm& algorithm) {
  if (algorithm.name == kAlgorithm) return;
  throw UserError(fmt::format(
      "--algorithm {}: place, rotation and scale of a scene are free, and {} alone can hold them, by its "
      "damping; leave the option out",
      algorithm.name, kAlgorithm));
}

void checkTolerance(double tolerance) {
  if (tolerance >= 0 && tolerance < 1) return;
  throw UserError(fmt::format("--tolerance {}: give a number from 0 on, and below 1", tolerance));
}

void checkOutput(const std::string& file) {
  if (formatOf(file) != Format::unknown) return;
  throw UserError(fmt::format(
      "--output {}: a result is a BAL file, FILE.txt or FILE.bal, or a cloud of points to look at, FILE.ply",
      file));
}

}  // namespace

Settings parseSettings(const RawOptions& raw) {
  Settings settings = raw.rest;
  settings.fit = parseFitOptions(raw.fit);
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
