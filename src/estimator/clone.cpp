// A deep copy of an estimator.
#include "estimator/state.hpp"

namespace slom {

Estimator Estimator::clone() const {
  Estimator copy;
  state_->copyTo(*copy.state_);
  return copy;
}

void Estimator::State::copyTo(State& copy) const {
  std::unique_ptr<LinearSolver> own = solver->makeAnother();
  if (own == nullptr) {
    throw Error(
        "slom.not-copyable",
        "the solver " + solver->description() +
            " cannot be copied; implement its makeAnother(), or change to one of the library before clone()",
        solver->description());
  }
  copy.problem.copyFrom(problem);
  copy.evaluator.setSolver(*own);
  copy.solver = std::move(own);
  copy.algorithm = algorithm->clone();
  if (threads > 0) copy.arena.setThreads(threads);
  copy.threads = threads;
  copy.given_derivatives = given_derivatives;
  copy.sigma = sigma;
  copy.gauge = gauge;
}

}  // namespace slom
