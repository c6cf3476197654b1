#include "fitting/console.hpp"

#include "printable.hpp"

namespace slom::app {

void addReportOptions(CLI::App& command, ReportOptions& options) {
  command.add_option("--json", options.json_file, "result and times as JSON; -: standard output")
      ->type_name("FILE");
  command.add_flag("--quiet", options.quiet, "print only errors");
}

Console::Console(const ReportOptions& options)
    : stream_(options.quiet            ? nullptr
              : options.jsonToStdout() ? stderr
                                       : stdout) {}

void Console::print(const std::string& text) const {
  if (stream_ == nullptr) return;
  std::fputs(printable(text).c_str(), stream_);
  std::fflush(stream_);
}

}  // namespace slom::app
