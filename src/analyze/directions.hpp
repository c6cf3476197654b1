/// Directions in which unknowns can move, described with the user's names.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "analyze/gauge.hpp"
#include "slom/analyze/diagnosis.hpp"

namespace slom {

/// Fraction of the largest entry of a direction below which entries are not reported.
inline constexpr double kNegligibleEntry = 1e-5;

/// Components that move along a direction, largest first. The amounts are relative to that of the first, which is 1.
struct Movement {
  std::vector<std::string> names, amounts;
};

/// Describes a direction. `direction` has an entry for each of `unknowns`, in unknowns scaled by `scale` (all
/// unknowns).
Movement movementAlong(const Eigen::VectorXd& direction, const Eigen::VectorXd& scale,
                       const std::vector<int>& unknowns, const std::function<std::string(int)>& name_of);

/// Returns a basis of the same space with few nonzero entries: each direction has 1 where the others have 0.
Eigen::MatrixXd basisOfFewEntries(Eigen::MatrixXd basis);

/// Describes a free gauge of a part: which variables move, how, and the remedy.
Finding findingOf(const Gauge& gauge, const ConnectedPart& part, const Problem& problem,
                  const ProblemStructure& structure);

}  // namespace slom
