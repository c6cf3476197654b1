// The online fit of an estimator.
#include <limits>
#include <ostream>
#include <utility>

#include "analyze/covariance.hpp"
#include "base/words.hpp"
#include "estimator/state.hpp"
#include "online/online_fit.hpp"

namespace slom {

namespace {
std::string messageOf(const UpdateSummary& summary, const UpdateOptions& options) {
  const std::string left = "a further step is predicted to reduce the RSS by " + number(summary.promise, 3);
  if (summary.converged) {
    const bool is_rounding = summary.promise > options.tolerance * summary.rss;
    return left + (is_rounding ? ", within rounding errors" : ", within the tolerance") +
           (summary.waiting > 0 ? "; " + counted(summary.waiting, "refused measurement") +
                                      (summary.waiting > 1 ? " wait" : " waits") + " for a trial"
                                : "");
  }
  if (summary.needs_optimize) {
    return "a step led uphill, far away, or to a place where an unknown has no influence; without a budget, "
           "optimize() would take over; call optimize() when there is time";
  }
  if (summary.is_put_off)
    return left + ", and the budget of " + number(options.budget, 3) +
           " operations is used up; call update() again";
  return left + " after " + counted(summary.steps, "step") + ", more than " + number(options.tolerance, 3) +
         " of the RSS; call update() again";
}
}  // namespace

std::ostream& operator<<(std::ostream& os, const UpdateSummary& summary) {
  os << (summary.converged ? "converged" : "not converged") << ": " << summary.message << "\nRSS "
     << number(summary.rss, 6) << ", " << counted(summary.steps, "step") << ", "
     << counted(summary.variables_moved, "move") << ", "
     << counted(summary.measurements_linearized, "linearisation") << ", "
     << counted(summary.fronts_factorized, "front") << (summary.reordered ? ", ordered anew" : "");
  if (summary.used_optimize)
    os << "; " << counted(summary.optimize_iterations, "iteration") << " of optimize()";
  os << "\n";
  if (summary.reconsidered > 0 || summary.waiting > 0) {
    os << counted(summary.reconsidered, "refused measurement") << " tried, " << summary.accepted
       << " accepted, " << summary.waiting << " waiting\n";
  }
  if (!summary.undetermined.empty()) {
    os << "not determined by measurements:";
    for (const std::string& name : summary.undetermined) os << ' ' << name;
    os << "\n";
  }
  return os;
}

void Estimator::writeUpdatedCovariance(int variable_a, int variable_b, double* block) const {
  if (state_->online == nullptr) {
    throw Error("slom.not-updated",
                "no covariance of an update for variable " + problem().variableName(variable_a) +
                    ": update() was never called; call update() first, or ask covariance()",
                problem().variableName(variable_a));
  }
  state_->online->writeCovariance(variable_a, variable_b, block);
  const double factor = state_->varianceFactor();
  const int entries = problem().variables()[static_cast<std::size_t>(variable_a)].dof *
                      problem().variables()[static_cast<std::size_t>(variable_b)].dof;
  for (int i = 0; i < entries; ++i) block[i] *= factor;
}

Marginals Estimator::updatedMarginals(double tolerance) {
  if (!(tolerance >= 0 && tolerance < 1)) {
    throw Error("slom.bad-option",
                "the tolerance of marginals is " + number(tolerance, 6) +
                    "; pass a number from 0 to below 1, such as 1e-3",
                "tolerance");
  }
  if (state_->online == nullptr) {
    throw Error("slom.not-updated",
                "no marginals of an update: update() was never called; call update() first, or "
                "ask marginals()",
                "");
  }
  OnlineFit& online = *state_->online;
  online.updateMarginals(tolerance);
  const auto write = [&](int variable, double* block) {
    if (!online.hasBlock(variable)) return false;
    online.writeMarginal(variable, block);
    return true;
  };
  return makeMarginals(problem(), write, state_->varianceFactor());
}

UpdateSummary Estimator::update(const UpdateOptions& options) {
  if (!(options.tolerance > 0 && options.tolerance < 1)) {
    throw Error(
        "slom.bad-option",
        "tolerance is " + number(options.tolerance, 6) + "; pass a number between 0 and 1, such as 1e-6",
        "tolerance");
  }
  if (options.max_steps < 1) {
    throw Error("slom.bad-option",
                "max_steps is " + std::to_string(options.max_steps) + "; pass a positive number, such as 100",
                "max_steps");
  }
  if (!(options.budget > 0)) {
    throw Error(
        "slom.bad-option",
        "budget is " + number(options.budget, 6) + "; pass a positive number of operations, such as 1e6",
        "budget");
  }
  State& state = *state_;
  if (!state.evaluator.collective().isAlone()) State::raiseNeedsAll();
  if (state.online == nullptr) state.online = std::make_unique<OnlineFit>(state.problem, state.linearizer);
  // Undetermined unknowns stay where they are, with update() as with a damped algorithm.
  const auto takeOver = [&] {
    Summary fit = optimize();
    if (fit.stop_reason != StopReason::rank_deficient) return fit;
    LevenbergMarquardt damped;
    return state.optimize(damped, {});
  };
  return state.run([&] {
    UpdateSummary summary;
    const bool has_bounds = state.problem.activeSet().hasBounds();
    if (!has_bounds && state.online->run(options, summary)) {
      summary.message = messageOf(summary, options);
      return summary;
    }
    const Summary fit = takeOver();
    summary.used_optimize = true;
    summary.converged = fit.converged;
    summary.rss = fit.final_rss;
    summary.promise = std::numeric_limits<double>::quiet_NaN();
    summary.optimize_iterations = fit.iterations;
    summary.message = "optimize() took over: " + fit.message;
    if (has_bounds) return summary;
    // This computes the promise at the end of optimize(), with the factor that later calls continue from. If optimize()
    // has converged, rounding may keep that factor from confirming it.
    const bool is_known = state.online->run(options, summary);
    if (is_known && summary.converged && !fit.converged)
      summary.message += "; " + messageOf(summary, options);
    summary.converged = fit.converged || (is_known && summary.converged);
    return summary;
  });
}

}  // namespace slom
