// How a run ends: its files, and what is said of a fit that failed.
#pragma once

#include <string>

#include "fitting/console.hpp"
#include "fitting/run_report.hpp"
#include "output_files.hpp"
#include "printable.hpp"

namespace slom::app {

/// The files of one run, which appear together. Those of a fit that failed are not written, as their readers
/// would take them for good; the JSON, which says so, is.
class ResultFiles {
 public:
  /// Both must outlive this.
  ResultFiles(const RunReport& report, const ReportOptions& options) : report_(report), options_(options) {}

  /// `content()` is the text of `file`; nothing happens for an empty name.
  template <class F>
  void add(const std::string& file, const F& content) {
    if (!file.empty()) add(file, report_.summary.converged, content);
  }
  /// Writes the JSON and gives all files their names; says which were written.
  void finish(const Console& console);

 private:
  template <class F>
  void add(const std::string& file, bool is_wanted, const F& content) {
    if (is_wanted) files_.add(file, content());
    said_ += (is_wanted ? "written: " : "not written, because the fit failed: ") + oneLine(file) + "\n";
  }

  const RunReport& report_;
  const ReportOptions& options_;
  OutputFiles files_;
  std::string said_;
};

/// Ends the run when the fit did not converge: says why, followed by `advice` and the warnings on the data.
void requireConverged(const RunReport& report, const std::string& advice);

}  // namespace slom::app
