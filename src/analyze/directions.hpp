/// Directions in which unknowns can move, in the user's names.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "analyze/gauge.hpp"
#include "slom/analyze/diagnosis.hpp"

namespace slom {

/// Entries of a direction that are smaller than this share of the largest are not reported.
inline constexpr double kNegligibleEntry = 1e-5;

/// The components that move along a direction, largest first, with the amounts that they move by when the first moves by 1.
struct Movement {
  std::vector<std::string> names, amounts;
};

/// `direction`: an entry for each of `unknowns`, in unknowns scaled by `scale` (all unknowns).
Movement movementAlong(const Eigen::VectorXd& direction, const Eigen::VectorXd& scale,
                       const std::vector<int>& unknowns, const std::function<std::string(int)>& name_of);

/// A basis of the same space with few entries: each direction has 1 where the others have 0.
Eigen::MatrixXd basisOfFewEntries(Eigen::MatrixXd basis);

/// A free gauge of a part: who moves, how, and the remedy.
Finding findingOf(const Gauge& gauge, const ConnectedPart& part, const Problem& problem,
                  const ProblemStructure& structure);

}  // namespace slom
