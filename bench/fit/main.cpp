// Time and memory of whole fits, by SLoM and by Ceres.
//
//   bench_fit [--threads N] [--rounds N] [--max-iterations N] [--robust huber:D] [--json FILE] ... PROBLEM...
//
// See --help. Prints a Markdown table. Ends with status 1 if two programs converge to the same minimum but differ there
// by more than 1e-8.
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include <mtk/error.hpp>
#include <slom/io/number.hpp>

#include "fit/json.hpp"
#include "fit/table.hpp"
#include "support/bad_input.hpp"
#include "support/build_info.hpp"

namespace {

using namespace slom::bench;

struct Arguments {
  std::vector<std::string> problems;
  ProblemOptions problem;
  ComparisonOptions comparison;
  std::string robust;
  double memory_gb = 0;
  std::string json;
};

void describe(CLI::App& app, Arguments& arguments) {
  ComparisonOptions& comparison = arguments.comparison;
  app.add_option(
         "problems", arguments.problems,
         "files of pose graphs (g2o, TORO) or of BAL; or generated ones of about SIZE poses or observations:\n"
         "grid2d:SIZE, sheet:SIZE, grid3d:SIZE, scene:SIZE")
      ->required()
      ->type_name("");
  app.add_option("--threads", comparison.limits.threads)->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--rounds", comparison.rounds, "how often each program is run; the median counts")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--max-iterations", comparison.limits.max_iterations)
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--robust", arguments.robust,
                 "loss of all measurements, huber:SCALE in standard deviations");
  app.add_option("--init", arguments.problem.init,
                 "of pose graphs: auto, file, odometry, spanning-tree, chordal or build-up");
  app.add_option("--deviations", arguments.problem.deviations,
                 "of all edges, as in 0.1,0.1,0.04, instead of what the files have")
      ->delimiter(',')
      ->expected(1, 6)
      ->allow_extra_args(false);
  app.add_option("--only", comparison.only,
                 "runs one program: SLoM, SPARSE_NORMAL_CHOLESKY, DENSE_SCHUR, ...")
      ->check(CLI::IsMember(programNames()));
  app.add_flag("!--no-factorization", comparison.with_factorization,
               "leaves out what factorisations need alone");
  app.add_option("--time-limit", comparison.child.seconds, "of each run [s], reading excluded; 0: none")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--memory-limit", arguments.memory_gb, "of each run [GB]; 0: none")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--json", arguments.json, "writes all numbers to this file")->type_name("FILE");
}

double huberScale(const std::string& text) {
  if (text.empty()) return 0;
  constexpr std::string_view huber = "huber:";
  double scale = 0;
  if (text.starts_with(huber) && slom::io::parseNumber(text.substr(huber.size()), scale) && scale > 0)
    return scale;
  throw BadInput("--robust " + text +
                 ": write huber:SCALE; SCALE is a positive number of standard deviations");
}

/// Returns false if a converged program has a cost other than the best one at the same minimum.
bool agree(const Comparison& comparison) {
  constexpr double tolerance = 1e-8, same_minimum = 1e-6;
  bool good = true;
  const double best = comparison.bestRss();
  for (const ProgramResult& result : comparison.programs) {
    if (!result.failure.empty() || !result.run.converged) continue;
    const double off = result.run.finalRss() / best - 1;
    if (off <= tolerance || off >= same_minimum) continue;
    std::cerr << "bench_fit: " << comparison.problem.name << ", " << result.program
              << ": the final RSS is off by " << off << "\n";
    good = false;
  }
  return good;
}

bool run(const Arguments& arguments) {
  Json results{{"machine", machineJson()}};
  Json& machine = results["machine"];
  std::cout << machine["processor"].get<std::string>() << ", " << instructionSet() << ", " << compilerName()
            << " " << compileFlags() << "; BLAS of CHOLMOD: " << blasLibrary();
  if (arguments.comparison.only.empty()) {  // otherwise a profiler is running, which dgemm would disturb
    addDgemm(machine);
    std::cout << "; dgemm " << 1e-9 * machine["dgemm_1024"].get<double>() << " GFLOP/s, of 48 x 48 "
              << 1e-9 * machine["dgemm_48"].get<double>();
  }
  std::cout << "\n\n" << std::flush;
  printHeader();
  bool good = true;
  Json& comparisons = results["comparisons"] = Json::array();
  for (const std::string& source : arguments.problems) {
    const Comparison comparison = compare(loadProblem(source, arguments.problem), arguments.comparison);
    printRows(comparison, arguments.comparison.limits.threads);
    comparisons.push_back(toJson(comparison, arguments.comparison));
    good = agree(comparison) && good;
  }
  if (!arguments.json.empty()) {
    std::ofstream file(arguments.json);
    file << results.dump(1) << "\n";
    if (!file.flush()) throw BadInput(arguments.json + ": cannot be written");
  }
  return good;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Times whole fits by SLoM and by Ceres, in turn, each in a process of its own.\n",
               "bench_fit");
  describe(app, arguments);
  try {
    app.parse(argc, argv);
    arguments.comparison.limits.huber = huberScale(arguments.robust);
    arguments.comparison.child.memory_bytes = 1e9 * arguments.memory_gb;
    return run(arguments) ? 0 : 1;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    std::cerr << "bench_fit: " << error.what() << "; see bench_fit --help\n";
  } catch (const BadInput& error) {
    std::cerr << "bench_fit: " << error.what() << "\n";
  } catch (const mtk::Error& error) {
    std::cerr << "bench_fit: " << error.what() << "\n";
  }
  return 2;
}
