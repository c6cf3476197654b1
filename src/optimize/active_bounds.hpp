/// Bounds of components during a fit: which of them are active, and steps that end at them.
///   source   Bertsekas, "Projected Newton methods for optimization problems with simple constraints", 1982
#pragma once

#include <functional>

#include <Eigen/Core>

#include "slom/linearize/linearize.hpp"

namespace slom {

/// Linearises into `sink`, and again as long as that changes which bounds are active: those where a component is at its limit and the RSS
/// falls beyond it. Brings `active` up to date; returns the RSS. `gradient` gives J^T r of what the sink got.
double linearizeAtBounds(const Problem& problem, const ProblemStructure& structure, Linearizer& linearizer,
                         ActiveSet& active, JacobianSink& sink,
                         const std::function<Eigen::VectorXd()>& gradient);

/// `d`, shortened in each component that it would take beyond a bound.
Eigen::VectorXd clampedToBounds(const Problem& problem, const ProblemStructure& structure,
                                const Eigen::VectorXd& d);

/// x + (limit - x) may be one rounding beyond the limit, where a user's function may have no value: moves such components to it.
void roundToBounds(const Problem& problem);

}  // namespace slom
