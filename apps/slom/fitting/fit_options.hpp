// Options shared by all commands that fit a problem from a file.
#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include <slom/model/loss.hpp>
#include <slom/optimize/named.hpp>
#include <slom/optimize/summary.hpp>
#include <slom/solve/named.hpp>

namespace slom {
class Estimator;
}

namespace slom::app {

struct FitOptions {
  NamedAlgorithm algorithm = algorithms().front();
  NamedSolver solver = solvers().front();
  Loss loss;        ///< loss of all measurements
  int threads = 0;  ///< 0: all of the machine
  int max_iterations = Options::kByTheSize;
  double max_seconds = 0;  ///< 0: no limit
};

/// The options as text from CLI11.
struct RawFitOptions {
  std::string algorithm = algorithms().front().name;
  std::string solver = solvers().front().name;
  std::string loss;
  int threads = 0;
  std::optional<int> max_iterations;  ///< nothing: the default of the library
  double max_seconds = 0;             ///< 0: no limit
};

/// Adds --algorithm, --solver, --threads, --max-iterations and --max-seconds. `raw` must live as long as `command`.
void addFitOptions(CLI::App& command, RawFitOptions& raw);
/// Adds --robust, for problems that define no losses.
void addLossOption(CLI::App& command, RawFitOptions& raw);

/// Reads the texts and checks all values. Throws UserError that names the option.
FitOptions parseFitOptions(const RawFitOptions& raw);

/// Sets algorithm, linear solver and threads.
void apply(const FitOptions& options, Estimator& estimator);

/// Returns the number of threads that the fit uses.
int threadsOf(const FitOptions& options);

}  // namespace slom::app
