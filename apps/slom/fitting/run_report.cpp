#include "fitting/run_report.hpp"

#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include <slom/solve/instruction_set.hpp>

#include "fitting/progress.hpp"

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

Json groupsJson(const Summary& summary) {
  Json groups = Json::array();
  for (const GroupSummary& group : summary.groups) {
    Json losses = Json::array();
    for (const LossSummary& loss : group.losses) {
      losses.push_back({{"loss", loss.loss},
                        {"measurements", loss.measurements},
                        {"down_weighted", loss.down_weighted},
                        {"weightless", loss.weightless}});
    }
    groups.push_back({{"name", group.name},
                      {"measurements", group.measurements},
                      {"residuals", group.residuals},
                      {"initial_rss", group.initial_rss},
                      {"final_rss", group.final_rss},
                      {"redundancy", group.redundancy < 0 ? Json() : Json(group.redundancy)},
                      {"derivatives", group.derivatives},
                      {"losses", losses}});
  }
  return groups;
}

Json warningsJson(const RunReport& report) {
  Json warnings = report.warnings;
  for (const std::string& warning : report.summary.warnings) warnings.push_back(warning);
  return warnings;
}

Json parametersJson(const Summary& summary) {
  Json parameters = Json::array();
  for (const ParameterSummary& p : summary.parameters) {
    parameters.push_back({{"name", p.name}, {"value", p.value}, {"std", p.standard_deviation}});
  }
  return parameters;
}

Json correlationsJson(const Summary& summary) {
  Json correlations = Json::array();
  for (const CorrelationSummary& c : summary.correlations) {
    correlations.push_back({{"a", c.a}, {"b", c.b}, {"correlation", c.correlation}});
  }
  return correlations;
}

}  // namespace

std::string toJson(const RunReport& report) {
  const Summary& s = report.summary;
  const PhaseSeconds& phases = s.phases;
  const Outcome outcome = outcomeOf(report);
  Json json = {{"converged", s.converged},
               {"stop_reason", toString(s.stop_reason)},
               {"message", s.message},
               {"warnings", warningsJson(report)},
               {"iterations", s.iterations},
               {"variables", s.variables},
               {"measurements", s.measurements},
               {"unknowns", s.unknowns},
               {"free_directions", report.free_directions},
               {"free_directions_are_all", report.has_all_free_directions},
               {"redundancy", outcome.redundancy()},
               {"initial_rss", s.initial_rss},
               {"final_rss", s.final_rss},
               {"chi2_per_dof", outcome.rssPerDof()},
               {"sigma", s.sigma_is_estimated ? "estimated" : "known"},
               {"threads", report.threads},
               {"solver", s.solver},
               {"kernels", instructionSet()},
               {"seconds",
                {{"load", report.load_seconds},
                 {"setup", report.setup_seconds + phases.setup},
                 {"linearize", phases.linearize},
                 {"factorize", phases.factorize},
                 {"solve", phases.solve},
                 {"total", report.total_seconds}}},
               {"peak_memory_mb", peakMemoryMb()},
               {"groups", groupsJson(s)},
               {"parameters", parametersJson(s)},
               {"correlations", correlationsJson(s)},
               {"active_bounds", s.active_bounds},
               {"trace", traceJson(s)}};
  if (report.online != nullptr) json["online"] = *report.online;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

double peakMemoryMb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return double(usage.ru_maxrss) * 1024 / 1e6;  // Linux counts in units of 1024 bytes
}

}  // namespace slom::app
