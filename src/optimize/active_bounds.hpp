/// Bounds of components during a fit: which of them are active, and steps that end at them.
///   source   Bertsekas, "Projected Newton methods for optimization problems with simple constraints", 1982
#pragma once

#include <Eigen/Core>

#include "slom/linearize/linearize.hpp"

namespace slom {

/// A bound is active where a component is at its limit and the RSS falls beyond it. Brings `active` up to date with the last
/// linearisation of `linearizer`, whose gradient is g; returns whether anything changed, so that columns of J are others.
bool updateActiveBounds(const Problem& problem, const ProblemStructure& structure,
                        const Linearizer& linearizer, const Eigen::VectorXd& g, ActiveSet& active);

/// `d`, shortened in each component that it would take beyond a bound.
Eigen::VectorXd clampedToBounds(const Problem& problem, const ProblemStructure& structure,
                                const Eigen::VectorXd& d);

/// x + (limit - x) may be one rounding beyond the limit, where a user's function may have no value: moves such components to it.
void roundToBounds(const Problem& problem);

}  // namespace slom
