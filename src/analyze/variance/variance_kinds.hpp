/// Variance components of measurements.
#pragma once

#include <string>
#include <vector>

#include "analyze/variance/variance_model.hpp"
#include "slom/analyze/variance_components.hpp"

namespace slom {

/// The components requested by the options, before residuals are evaluated.
struct VarianceKinds {
  std::vector<std::string> names;         ///< of the kinds that are estimated
  std::vector<std::vector<int>> of_pool;  ///< by pool and measurement: its kind; -1: as stated
  std::vector<SharedTerm> shared;         ///< as in VarianceOptions
  std::vector<std::string> shared_names;  ///< `tape, shared by day`
  std::vector<int> shared_kind;           ///< the kind that has the error; -1: a kind that is not estimated
  std::vector<std::string> kept;          ///< names of the kinds that are not estimated
  std::vector<int> measurements;          ///< by kind
};

/// Makes the components. Throws [slom.no-groups], [slom.bad-group], [slom.no-component] or [slom.components-with-loss].
VarianceKinds makeVarianceKinds(const Problem& problem, const VarianceOptions& options);

}  // namespace slom
