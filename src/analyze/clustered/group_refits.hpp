/// Fits without one group of measurements at a time.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "analyze/clusters.hpp"
#include "slom/linearize/structure.hpp"

namespace slom {

/// How far values move without each group.
struct GroupRefits {
  Eigen::MatrixXd change;           ///< groups x unknowns; NaN where the others do not determine the value
  std::vector<std::string> failed;  ///< groups without which the fit does not converge; their rows are NaN
};

/// `fit` fits from the current values, and says whether that has converged. Values, noise and what is fixed are as before when this returns or throws.
GroupRefits refitWithoutGroups(Problem& problem, const ProblemStructure& structure, const Clustering& way,
                               const std::function<bool()>& fit);

}  // namespace slom
