#include "fitting/result_files.hpp"

#include <cstdio>

#include <fmt/format.h>

#include "error.hpp"
#include "printable.hpp"

namespace slom::app {

void ResultFiles::begin(const std::string& file) {
  if (isWanted(file)) files_.open(file);
  if (!file.empty()) note(file, isWanted(file));
}

void ResultFiles::note(const std::string& file, bool is_wanted) {
  said_ += (is_wanted ? "written: " : "not written, because the fit failed: ") + oneLine(file) + "\n";
}

void ResultFiles::finish(const Console& console) {
  const std::string json = options_.json_file.empty() ? "" : toJson(report_);
  if (!options_.jsonPath().empty()) add(options_.jsonPath(), true, [&] { return json; });
  files_.commit();
  if (!said_.empty()) console.print("\n" + said_);
  if (options_.jsonToStdout()) std::fputs(json.c_str(), stdout);  // main() checks that it arrived
}

void requireConverged(const RunReport& report, const std::string& advice) {
  if (report.summary.converged) return;
  sayError(
      fmt::format("slom: the fit failed: {}{}{}\n", report.summary.message, advice,
                  report.warnings.empty() ? "" : fmt::format(" ({})", fmt::join(report.warnings, "; "))));
  throw CLI::RuntimeError(exit_not_converged);
}

}  // namespace slom::app
