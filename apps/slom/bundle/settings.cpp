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
