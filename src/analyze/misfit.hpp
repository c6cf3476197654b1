#pragma once

#include <string>
#include <vector>

#include "slom/optimize/summary.hpp"
#include "slom/problem/problem.hpp"

namespace slom {

/// Returns sentences about a fit whose residuals, in all or in a group, are far from those expected from the stated
/// standard deviations. Also names groups that a loss treats almost entirely as outliers.
std::vector<std::string> misfits(const Problem& problem, const Summary& summary);

}  // namespace slom
