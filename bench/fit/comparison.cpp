#include "fit/comparison.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <type_traits>

#include "fit/json.hpp"

namespace slom::bench {

namespace {

constexpr double kQuickSeconds = 0.5;

struct Program {
  std::string name;
  std::function<Run()> fit;
};

std::vector<Program> programsFor(const Problem& problem, const Limits& limits) {
  return std::visit(
      [&](const auto& data) {
        std::vector<Program> programs{{"SLoM", [&] { return fitBySlom(data, limits); }}};
#ifdef SLOM_BENCH_CERES
        if constexpr (std::is_same_v<std::decay_t<decltype(data)>, io::Scene>) {
          programs.push_back({"Ceres, DENSE_SCHUR", [&] { return fitByCeres(data, Schur::dense, limits); }});
          programs.push_back(
              {"Ceres, SPARSE_SCHUR", [&] { return fitByCeres(data, Schur::sparse, limits); }});
          programs.push_back(
              {"Ceres, ITERATIVE_SCHUR", [&] { return fitByCeres(data, Schur::iterative, limits); }});
        } else {
          programs.push_back({"Ceres, SPARSE_NORMAL_CHOLESKY", [&] { return fitByCeres(data, limits); }});
        }
#endif
        return programs;
      },
      problem.data);
}

Run runWarm(const Program& program) {
  Run run = program.fit();
  if (run.seconds < kQuickSeconds) run = program.fit();
  return run;
}

void addRun(const Program& program, const ChildLimits& limits, double base_bytes, ProgramResult& result,
            std::vector<Run>& runs) {
  const ChildOutcome outcome = runInChild([&] { return toJson(runWarm(program)).dump(); }, limits);
  if (!outcome.ok) {
    result.failure = outcome.text;
    return;
  }
  runs.push_back(runFromJson(Json::parse(outcome.text)));
  result.seconds.push_back(runs.back().seconds);
  result.memory_bytes = std::max(result.memory_bytes, outcome.peak_bytes - base_bytes);
}

/// Runs all programs in turn. A program that failed once is not run again.
std::vector<ProgramResult> runInTurn(const std::vector<Program>& programs, const ComparisonOptions& options) {
  const double base_bytes = runInChild([] { return std::string(); }, {}).peak_bytes;
  std::vector<ProgramResult> results;
  for (const Program& program : programs) results.push_back({program.name, "", {}, {}, 0});
  std::vector<std::vector<Run>> runs(programs.size());
  for (int round = 0; round < options.rounds; ++round) {
    for (std::size_t p = 0; p < programs.size(); ++p) {
      if (results[p].failure.empty()) addRun(programs[p], options.child, base_bytes, results[p], runs[p]);
    }
  }
  for (std::size_t p = 0; p < programs.size(); ++p) {
    if (!results[p].failure.empty()) continue;
    const auto middle = runs[p].begin() + static_cast<std::ptrdiff_t>(runs[p].size() / 2);
    std::nth_element(runs[p].begin(), middle, runs[p].end(),
                     [](const Run& a, const Run& b) { return a.seconds < b.seconds; });
    results[p].run = *middle;
  }
  return results;
}

std::optional<Factorization> measure(const std::function<Factorization()>& work, const ChildLimits& limits) {
  const ChildOutcome outcome = runInChild([&] { return toJson(work()).dump(); }, limits);
  if (!outcome.ok) return std::nullopt;
  return factorizationFromJson(Json::parse(outcome.text));
}

void addFactorizations(const Problem& problem, const ChildLimits& limits, Comparison& comparison) {
  std::visit(
      [&](const auto& data) {
        if constexpr (!std::is_same_v<std::decay_t<decltype(data)>, io::Scene>) {
          comparison.slom = measure([&] { return analyzeBySlom(data); }, limits);
#ifdef SLOM_BENCH_CHOLMOD
          comparison.cholmod = measure([&] { return factorizeByCholmod(data); }, limits);
#endif
        }
      },
      problem.data);
}

}  // namespace

double Comparison::bestRss() const {
  double best = std::numeric_limits<double>::infinity();
  for (const ProgramResult& result : programs) {
    if (result.failure.empty()) best = std::min(best, result.run.finalRss());
  }
  return best;
}

const std::vector<std::string>& programNames() {
  static const std::vector<std::string> names{"SLoM", "SPARSE_NORMAL_CHOLESKY", "DENSE_SCHUR", "SPARSE_SCHUR",
                                              "ITERATIVE_SCHUR"};
  return names;
}

Comparison compare(Problem problem, const ComparisonOptions& options) {
  Comparison comparison;
  std::vector<Program> programs = programsFor(problem, options.limits);
  std::erase_if(programs, [&](const Program& program) { return !program.name.ends_with(options.only); });
  comparison.programs = runInTurn(programs, options);
  if (options.with_factorization && options.only.empty())
    addFactorizations(problem, options.child, comparison);
  comparison.variables = problem.variables();
  comparison.measurements = problem.measurements();
  problem.data = AnyProblem();
  comparison.problem = std::move(problem);
  return comparison;
}

}  // namespace slom::bench
