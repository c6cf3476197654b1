/// All programs on one problem, each run in its own process.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fit/problem.hpp"
#include "fit/run.hpp"
#include "support/child_process.hpp"

namespace slom::bench {

/// Results of one program in all rounds.
struct ProgramResult {
  std::string program;
  std::string failure;          ///< why there is no run; otherwise empty
  Run run;                      ///< the round with the median time
  std::vector<double> seconds;  ///< times of all rounds
  double memory_bytes = 0;      ///< largest memory of a run, beyond the problem as read
};

struct Comparison {
  Problem problem;  ///< without its data
  std::size_t variables = 0, measurements = 0;
  std::vector<ProgramResult> programs;  ///< SLoM, if it was run, comes first
  std::optional<Factorization> slom, cholmod;

  /// Returns the lowest RSS of all programs.
  double bestRss() const;
};

struct ComparisonOptions {
  Limits limits;
  int rounds = 3;
  std::string only;                ///< program; empty: all
  bool with_factorization = true;  ///< for graphs only
  ChildLimits child;               ///< limits of each run
};

/// Compares the programs, which take turns. A fit of less than 0.5 s is run twice in its process and the second run
/// counts, because the first run touches memory and code for the first time.
Comparison compare(Problem problem, const ComparisonOptions& options);

/// Returns the names for ComparisonOptions::only.
const std::vector<std::string>& programNames();

}  // namespace slom::bench
