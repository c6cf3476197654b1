// Where a command that fits says what it does.
#pragma once

#include <cstdio>
#include <string>

#include <CLI/CLI.hpp>

namespace slom::app {

/// The options that say where a fit is reported.
struct ReportOptions {
  std::string json_file;  ///< empty: none; "-": standard output
  bool quiet = false;

  bool jsonToStdout() const { return json_file == "-"; }
  /// Empty also where the JSON goes to standard output.
  std::string jsonPath() const { return jsonToStdout() ? "" : json_file; }
};

/// Adds --json and --quiet; `options` must live as long as `command`.
void addReportOptions(CLI::App& command, ReportOptions& options);

/// Where people read: standard output, but standard error when the JSON goes there; nowhere with --quiet.
class Console {
 public:
  explicit Console(const ReportOptions& options);
  /// Shown at once.
  void print(const std::string& text) const;

 private:
  std::FILE* stream_;
};

}  // namespace slom::app
