/// Bounds of components during a fit: the active ones, and steps that end at them.
///   source   Bertsekas, "Projected Newton methods for optimization problems with simple constraints", 1982
#pragma once

#include <functional>

#include <Eigen/Core>

#include "slom/linearize/linearize.hpp"

namespace slom {

/// Linearises into `sink`, and repeats while that changes which bounds are active. A bound is active if its component
/// is at the limit and the RSS falls beyond it. Updates `active` and returns the RSS. `gradient` returns J^T r of the
/// sink's contents.
double linearizeAtBounds(const Problem& problem, const ProblemStructure& structure, Linearizer& linearizer,
                         ActiveSet& active, JacobianSink& sink,
                         const std::function<Eigen::VectorXd()>& gradient);

/// Returns `d`, shortened in each component that would pass a bound.
Eigen::VectorXd clampedToBounds(const Problem& problem, const ProblemStructure& structure,
                                const Eigen::VectorXd& d);

/// Moves to its limit each component that is one rounding beyond it. x + (limit - x) may be there, and a user's
/// function may have no value there.
void roundToBounds(const Problem& problem);

}  // namespace slom
