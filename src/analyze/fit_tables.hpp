/// What a summary says of groups, parameters and bounds.
#pragma once

#include <string>
#include <vector>

#include "analyze/linearized_problem.hpp"
#include "slom/analyze/uncertainty.hpp"
#include "slom/optimize/summary.hpp"

namespace slom {

/// A row for each group: its sizes and the RSS before the fit, or the RSS after it and what its losses did. `rss`: that of each pool.
void fillGroups(const Problem& problem, const std::vector<double>& rss, Summary& summary, bool before);

/// Values, standard deviations and strong correlations of all unknowns, and the redundancy of each group. Throws, and leaves the
/// summary as it is, where there are no covariances.
void fillParameters(const LinearizedProblem& linearized, FreeGauge gauge, double variance_factor,
                    Summary& summary);

/// The table of parameters alone, where the summary has none: with standard deviations from the selected inverse. Throws
/// [slom.no-parameters], and what covariances throw.
void addParameters(const LinearizedProblem& linearized, FreeGauge gauge, double variance_factor,
                   Summary& summary);

/// An unknown as a row of the table of parameters.
struct UnknownRow {
  int variable, component;
  ParameterSummary row;
  bool is_at_bound;  ///< its standard deviation is 0
};
/// Rows of all unknowns, those at a bound too, with standard deviations from the selected inverse. Throws what covariances throw.
std::vector<UnknownRow> unknownRows(const LinearizedProblem& linearized, FreeGauge gauge,
                                    double variance_factor, bool& has_rotations);

/// `camera.k3 is at its upper bound 0.5`
std::vector<std::string> activeBounds(const Problem& problem);

}  // namespace slom
