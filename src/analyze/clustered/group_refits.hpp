/// Fits without one group of measurements at a time.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "analyze/clusters.hpp"
#include "slom/linearize/structure.hpp"

namespace slom {

/// Movement of the values without each group.
struct GroupRefits {
  Eigen::MatrixXd change;           ///< groups x unknowns; NaN if the other groups do not determine the value
  std::vector<std::string> failed;  ///< groups without which the fit does not converge; their rows are NaN
};

/// Fits without each group. `fit` fits from the current values and returns whether it converged. Values, noise and
/// fixed variables are restored, also if this function throws.
GroupRefits refitWithoutGroups(Problem& problem, const ProblemStructure& structure, const Clustering& way,
                               const std::function<bool()>& fit);

}  // namespace slom
