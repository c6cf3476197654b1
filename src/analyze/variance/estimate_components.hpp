/// Variance components of a linearised problem.
#pragma once

#include "analyze/linearized_problem.hpp"
#include "slom/analyze/variance_components.hpp"

namespace slom {

/// The measurements of each component.
struct [[gnu::visibility(
    "hidden")]] VarianceComponents::Assignment {  // declared in a public header, not exported
  const Problem* problem = nullptr;
  std::uint64_t structure_revision = 0;
  std::vector<std::vector<int>> of_pool;  ///< by pool and measurement: its component; -1: none
};

/// Estimates the components. Throws as slom::varianceComponents() does, except for [slom.not-a-minimum].
VarianceComponents estimateComponents(const LinearizedProblem& linearized, FreeGauge gauge,
                                      const VarianceOptions& options);

}  // namespace slom
