/// What analyses see of an estimator: all that it owns.
#pragma once

#include <Eigen/Core>

#include "estimator/state.hpp"
#include "slom/analyze/clustered.hpp"

namespace slom {

namespace detail {
struct [[gnu::visibility("hidden")]] AnalysisAccess {  // declared in public headers, not exported
  using State = Estimator::State;
  static State& state(const Estimator& est) { return *est.state_; }

  static const Problem& problem(const Clustered& clustered) { return clustered.problem(); }
  /// Half the widths of the intervals of the variable's components.
  static Eigen::VectorXd halfWidths(const Clustered& clustered, int variable, double probability) {
    Eigen::VectorXd result(problem(clustered).variables()[static_cast<std::size_t>(variable)].dof);
    clustered.writePerComponent(variable, Clustered::Kind::interval, probability, result.data());
    return result;
  }
};
}  // namespace detail

using EstimatorState = detail::AnalysisAccess::State;

/// Throws [slom.moved-from].
inline EstimatorState& stateOf(const Estimator& est) { return detail::AnalysisAccess::state(est); }

}  // namespace slom
