#include "fit/json.hpp"

#include <cmath>
#include <thread>

#include "support/build_info.hpp"
#include "support/dgemm.hpp"

namespace slom::bench {

namespace {

/// Calls f(name, number) for all plain numbers of a run.
template <class AnyRun, class F>
void forEachNumber(AnyRun& run, const F& f) {
  f("iterations", run.iterations);
  f("factorizations", run.factorizations);
  f("build", run.build_seconds);
  f("total", run.seconds);
  f("setup", run.setup_seconds);
  f("iteration", run.iteration_seconds);
  f("linearize", run.linearize_seconds);
  f("factorize", run.factor_seconds);
  f("solve", run.solve_seconds);
}

Json programJson(const ProgramResult& result, double best) {
  Json json{{"program", result.program}};
  if (!result.failure.empty()) {
    json["failure"] = result.failure;
    return json;
  }
  json.update(toJson(result.run));
  json["seconds_of_rounds"] = result.seconds;
  json["final_rss"] = result.run.finalRss();
  json["to_1e-3"] = result.run.secondsUntil(best, 1e-3);  // NaN becomes null
  json["to_1e-6"] = result.run.secondsUntil(best, 1e-6);
  json["memory"] = result.memory_bytes;
  return json;
}

}  // namespace

Json toJson(const Run& run) {
  Json json{{"solver", run.solver}, {"converged", run.converged}};
  forEachNumber(run, [&](const char* name, const auto& value) { json[name] = value; });
  Json& trace = json["trace"] = Json::array();
  for (const TracePoint& point : run.trace) trace.push_back({point.seconds, point.rss});
  return json;
}

Run runFromJson(const Json& json) {
  Run run;
  json.at("solver").get_to(run.solver);
  json.at("converged").get_to(run.converged);
  forEachNumber(run, [&](const char* name, auto& value) { json.at(name).get_to(value); });
  for (const Json& point : json.at("trace")) {
    run.trace.push_back({point[0].get<double>(), point[1].is_null() ? std::nan("") : point[1].get<double>()});
  }
  return run;
}

Json toJson(const Factorization& factorization) {
  return {{"symbolic", factorization.symbolic_seconds},
          {"numeric", factorization.numeric_seconds},
          {"flops", factorization.flops}};
}

Factorization factorizationFromJson(const Json& json) {
  return {json.at("symbolic").get<double>(), json.at("numeric").get<double>(),
          json.at("flops").get<double>()};
}

Json toJson(const Comparison& comparison, const ComparisonOptions& options) {
  const Problem& problem = comparison.problem;
  Json json{{"problem", problem.name},
            {"kind", problem.kind},
            {"generated", problem.is_generated},
            {"start", problem.start},
            {"variables", comparison.variables},
            {"measurements", comparison.measurements},
            {"threads", options.limits.threads},
            {"huber", options.limits.huber},
            {"max_iterations", options.limits.max_iterations}};
  const auto orNull = [](const std::optional<Factorization>& f) { return f ? toJson(*f) : Json(); };
  json["slom_factor"] = orNull(comparison.slom);
  json["cholmod_factor"] = orNull(comparison.cholmod);
  const double best = comparison.bestRss();
  Json& programs = json["programs"] = Json::array();
  for (const ProgramResult& result : comparison.programs) programs.push_back(programJson(result, best));
  return json;
}

Json machineJson() {
  return {{"processor", processorName()},     {"cores", std::thread::hardware_concurrency()},
          {"instructions", instructionSet()}, {"compiler", compilerName()},
          {"flags", compileFlags()},          {"blas", blasLibrary()}};
}

void addDgemm(Json& machine) {
  machine["dgemm_1024"] = dgemmRate(1024);
  machine["dgemm_48"] = dgemmRate(48);
}

}  // namespace slom::bench
