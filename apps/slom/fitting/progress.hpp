// What a fit says while it runs and when it is done.
#pragma once

#include <string>

#include <slom/optimize/summary.hpp>

#include "fitting/run_report.hpp"

namespace slom::app {

/// The heads of the columns of iterationText.
std::string iterationHeader();
std::string iterationText(const IterationRecord& record);

/// The figures by which a fit is reported.
struct Outcome {
  bool converged = false;
  int iterations = 0;
  std::string stop_reason;
  std::string message;  ///< the reason in a sentence; shown when the fit did not converge
  int measurements = 0;
  int unknowns = 0;
  double rss = 0;
  bool is_robust = false;               ///< some measurements have a loss, so that there is no chi-square
  int free_directions = 0;              ///< which no measurement determines
  bool has_all_free_directions = true;  ///< false: there may be more

  /// With has_all_free_directions = false the redundancy is at least this.
  int redundancy() const { return measurements - unknowns + free_directions; }
  /// NaN without redundancy; with has_all_free_directions = false at most this.
  double rssPerDof() const;
};
Outcome outcomeOf(const RunReport& report);

/// `Converged after ...`, the numbers of measurements and unknowns, the RSS, what went wrong.
std::string outcomeText(const Outcome& outcome);

}  // namespace slom::app
