// Clustered covariances of a fit.
#include "analyze/clustered_state.hpp"
#include "estimator_state.hpp"
#include "slom/analyze/clustered.hpp"

namespace slom {

Clustered Estimator::clustered() const { return clustered(ClusterOptions{}); }

Clustered Estimator::clustered(const ClusterOptions& options) const {
  const double factor = state_->varianceFactor();
  if (!state_->isAtMinimum(factor)) {
    throw Error("slom.not-a-minimum",
                "clustered covariances are those of a fit, and the values are not at one; call optimize() "
                "and see in its summary whether it has converged",
                "clustered");
  }
  return state_->analyze([&](const LinearizedProblem&) {
    return Clustered(std::make_shared<Clustered::State>(state_->current, state_->gauge, factor, options));
  });
}

}  // namespace slom
