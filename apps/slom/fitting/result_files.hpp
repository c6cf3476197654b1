// End of a run: its files, and the error for a failed fit.
#pragma once

#include <string>
#include <string_view>

#include "fitting/console.hpp"
#include "fitting/run_report.hpp"
#include "output_files.hpp"

namespace slom::app {

/// The files of one run, which appear together. If the fit failed, only the JSON is written, which reports the failure.
/// Readers of the other files would take them for good.
class ResultFiles {
 public:
  /// Refers to both arguments, which must outlive this object.
  ResultFiles(const RunReport& report, const ReportOptions& options) : report_(report), options_(options) {}

  /// Adds a file with the text `content()`. Does nothing if the name is empty.
  template <class F>
  void add(const std::string& file, const F& content) {
    if (!file.empty()) add(file, report_.summary.converged, content);
  }
  /// Returns whether the file is wanted: it has a name, and the fit did not fail.
  bool isWanted(const std::string& file) const { return !file.empty() && report_.summary.converged; }
  /// Begins a file that is written in pieces, if it is wanted; append() adds to it, end() ends it.
  void begin(const std::string& file);
  void append(std::string_view piece) { files_.append(piece); }
  void end() { files_.close(); }
  /// Writes the JSON and gives all files their names. Prints which files were written.
  void finish(const Console& console);

 private:
  template <class F>
  void add(const std::string& file, bool is_wanted, const F& content) {
    if (is_wanted) files_.add(file, content());
    note(file, is_wanted);
  }
  /// Notes for the report whether a file was written.
  void note(const std::string& file, bool is_wanted);

  const RunReport& report_;
  const ReportOptions& options_;
  OutputFiles files_;
  std::string said_;
};

/// Ends the run if the fit did not converge. Prints the reason, followed by `advice` and the warnings on the data.
void requireConverged(const RunReport& report, const std::string& advice);

}  // namespace slom::app
