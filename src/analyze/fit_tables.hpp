/// Tables of a summary: groups, parameters and bounds.
#pragma once

#include <string>
#include <vector>

#include "analyze/linearized_problem.hpp"
#include "slom/analyze/uncertainty.hpp"
#include "slom/optimize/summary.hpp"

namespace slom {

/// Fills a row for each group. Before the fit: its sizes and its RSS; after: its RSS and the effect of its losses.
/// `rss` holds the RSS of each pool.
void fillGroups(const Problem& problem, const std::vector<double>& rss, Summary& summary, bool before);

/// Fills in values, standard deviations and strong correlations of all unknowns, and the redundancy of each group. If
/// there are no covariances, throws and leaves the summary unchanged.
void fillParameters(const LinearizedProblem& linearized, FreeGauge gauge, double variance_factor,
                    Summary& summary);

/// Adds the table of parameters to a summary without one, with standard deviations from the selected inverse. Throws
/// [slom.no-parameters], and the errors of covariances.
void addParameters(const LinearizedProblem& linearized, FreeGauge gauge, double variance_factor,
                   Summary& summary);

/// An unknown as a row of the table of parameters.
struct UnknownRow {
  int variable, component;
  ParameterSummary row;
  bool is_at_bound;  ///< its standard deviation is 0
};
/// Returns the rows of all unknowns, including those at a bound, with standard deviations from the selected inverse.
/// Throws the errors of covariances.
std::vector<UnknownRow> unknownRows(const LinearizedProblem& linearized, FreeGauge gauge,
                                    double variance_factor, bool& has_rotations);

/// Returns sentences such as `camera.k3 is at its upper bound 0.5`.
std::vector<std::string> activeBounds(const Problem& problem);

}  // namespace slom
