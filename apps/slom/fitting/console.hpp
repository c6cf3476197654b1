// Console output of a command that fits.
#pragma once

#include <cstdio>
#include <string>

#include <CLI/CLI.hpp>

namespace slom::app {

/// Options that select the reports of a fit.
struct ReportOptions {
  std::string json_file;  ///< empty: none; "-": standard output
  bool quiet = false;

  bool jsonToStdout() const { return json_file == "-"; }
  /// Returns the path of the JSON file; empty if there is none or the JSON goes to standard output.
  std::string jsonPath() const { return jsonToStdout() ? "" : json_file; }
};

/// Adds --json and --quiet. `options` must live as long as `command`.
void addReportOptions(CLI::App& command, ReportOptions& options);

/// The console: standard output, or standard error if the JSON goes to standard output. With --quiet, there is no
/// output.
class Console {
 public:
  explicit Console(const ReportOptions& options);
  /// Prints at once.
  void print(const std::string& text) const;

 private:
  std::FILE* stream_;
};

}  // namespace slom::app
