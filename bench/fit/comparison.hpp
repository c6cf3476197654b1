/// All programs on one problem, each run in a process of its own.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fit/problem.hpp"
#include "fit/run.hpp"
#include "support/child_process.hpp"

namespace slom::bench {

/// What one program did in all rounds.
struct ProgramResult {
  std::string program;
  std::string failure;          ///< why there is no run; otherwise empty
  Run run;                      ///< the round with the median time
  std::vector<double> seconds;  ///< times of all rounds
  double memory_bytes = 0;      ///< most that a run had beside the problem as it was read
};

struct Comparison {
  Problem problem;  ///< without its data
  std::size_t variables = 0, measurements = 0;
  std::vector<ProgramResult> programs;  ///< SLoM, if it was run, is the first
  std::optional<Factorization> slom, cholmod;

  /// The lowest RSS of all.
  double bestRss() const;
};

struct ComparisonOptions {
  Limits limits;
  int rounds = 3;
  std::string only;                ///< program; empty: all
  bool with_factorization = true;  ///< for graphs only
  ChildLimits child;               ///< limits of each run
};

/// The programs take turns. Fits of less than half a second are run twice in their process, and the second run counts: the
/// first one touches memory and code for the first time.
Comparison compare(Problem problem, const ComparisonOptions& options);

/// Names for ComparisonOptions::only.
const std::vector<std::string>& programNames();

}  // namespace slom::bench
