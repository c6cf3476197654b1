#include "fitting/run_report.hpp"

#include <nlohmann/json.hpp>
#include <sys/resource.h>

namespace slom::app {

namespace {

using Json = nlohmann::ordered_json;

Json traceJson(const Summary& summary) {
  Json trace = Json::array();
  for (const IterationRecord& record : summary.trace) {
    trace.push_back({{"iteration", record.iteration}, {"rss", record.rss}, {"seconds", record.seconds}});
  }
  return trace;
}

}  // namespace

std::string toJson(const RunReport& report) {
  const Summary& s = report.summary;
  const PhaseSeconds& phases = s.phases;
  const Json json = {{"converged", s.converged},
                     {"stop_reason", toString(s.stop_reason)},
                     {"iterations", s.iterations},
                     {"variables", s.variables},
                     {"measurements", s.measurements},
                     {"unknowns", s.unknowns},
                     {"initial_rss", s.initial_rss},
                     {"final_rss", s.final_rss},
                     {"threads", report.threads},
                     {"solver", s.solver},
                     {"seconds",
                      {{"load", report.load_seconds},
                       {"setup", report.setup_seconds + phases.setup},
                       {"linearize", phases.linearize},
                       {"factorize", phases.factorize},
                       {"solve", phases.solve},
                       {"total", report.total_seconds}}},
                     {"peak_memory_mb", peakMemoryMb()},
                     {"trace", traceJson(s)}};
  return json.dump(2) + "\n";
}

double peakMemoryMb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return double(usage.ru_maxrss) * 1024 / 1e6;  // Linux counts in units of 1024 bytes
}

}  // namespace slom::app
