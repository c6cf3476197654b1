// The online fit of an estimator.
#include "base/words.hpp"
#include "estimator_state.hpp"
#include "online/online_fit.hpp"

namespace slom {

namespace {
std::string messageOf(const UpdateSummary& summary, const UpdateOptions& options) {
  const std::string left = "a further step promises a decrease of the RSS by " + number(summary.promise, 3);
  if (summary.converged) return left + ", within the tolerance";
  return left + " after " + counted(summary.steps, "step") + ", more than " + number(options.tolerance, 3) +
         " of it; call update() again";
}
}  // namespace

UpdateSummary Estimator::update(const UpdateOptions& options) {
  if (!(options.tolerance > 0)) {
    throw Error("slom.bad-option",
                "tolerance is " + number(options.tolerance, 6) + "; pass a positive number, such as 1e-6",
                "tolerance");
  }
  if (options.max_steps < 1) {
    throw Error("slom.bad-option",
                "max_steps is " + std::to_string(options.max_steps) + "; pass a positive number",
                "max_steps");
  }
  State& state = *state_;
  if (state.online == nullptr) state.online = std::make_unique<OnlineFit>(state.problem, state.linearizer);
  return state.run([&] {
    UpdateSummary summary;
    const bool has_bounds = state.problem.activeSet().hasBounds();
    if (!has_bounds && state.online->run(options, summary)) {
      summary.message = messageOf(summary, options);
      return summary;
    }
    const Summary fit = optimize();
    summary.used_optimize = true;
    summary.converged = fit.converged;
    summary.rss = fit.final_rss;
    summary.promise = 0;
    if (!has_bounds) static_cast<void>(state.online->run(options, summary));
    summary.message = "optimize() took over: " + fit.message;
    return summary;
  });
}

}  // namespace slom
