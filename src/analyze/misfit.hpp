#pragma once

#include <string>
#include <vector>

#include "slom/optimize/summary.hpp"
#include "slom/problem/problem.hpp"

namespace slom {

/// Sentences about a fit whose residuals are far from what the stated standard deviations let expect, overall
/// or in a group, and about groups that a loss takes for outliers nearly as a whole.
std::vector<std::string> misfits(const Problem& problem, const Summary& summary);

}  // namespace slom
