// Texts of a fit while it runs and at its end.
#pragma once

#include <string>

#include <slom/optimize/summary.hpp>

#include "fitting/run_report.hpp"

namespace slom::app {

/// Returns the column headings of iterationText.
std::string iterationHeader();
std::string iterationText(const IterationRecord& record);

/// Figures in the report of a fit.
struct Outcome {
  bool converged = false;
  int iterations = 0;
  std::string stop_reason;
  std::string message;  ///< reason in a sentence; shown if the fit did not converge
  int measurements = 0;
  int unknowns = 0;
  double rss = 0;
  bool is_robust = false;               ///< some measurements have a loss, so there is no chi-square
  int free_directions = 0;              ///< number of directions that no measurement determines
  bool has_all_free_directions = true;  ///< false: there may be more

  /// Returns the redundancy; a lower bound if has_all_free_directions is false.
  int redundancy() const { return measurements - unknowns + free_directions; }
  /// Returns RSS / redundancy; NaN without redundancy, an upper bound if has_all_free_directions is false.
  double rssPerDof() const;
};
Outcome outcomeOf(const RunReport& report);

/// Returns `Converged after ...`, the numbers of measurements and unknowns, the RSS, and faults.
std::string outcomeText(const Outcome& outcome);

}  // namespace slom::app
