// Promise: the decrease that the linear model predicts without damping, and whether it can be trusted.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "slom/optimize/evaluator.hpp"

namespace slom {

Evaluator::Promise Evaluator::promise(bool carefully, double most) {
  linearize();
  Promise result;
  const auto decreaseBy = [&](const Eigen::VectorXd& step) {
    // Both values are g^T H^-1 g. A difference, or a negative value, is rounding error. An inexact solver may find
    // less, even 0.
    return std::max({std::abs(collective_->dot(solver_->gradient(), step)), predictedDecrease(step),
                     solver_->isExact() ? 0.0 : promiseOfOneUnknown()});
  };
  if (carefully && careful_failed_at_ != structured_at_ && solver_->isExact() &&
      solveUndamped(result.step).ok) {
    result.decrease = decreaseBy(result.step);
    result.is_known = result.has_full_rank = std::isfinite(result.decrease);
    return result;
  }
  std::vector<int> unseen;
  const Eigen::VectorXd& H = solver_->diagonal();
  const auto promised = [&](double damping, Eigen::VectorXd& step) {
    Eigen::VectorXd D = damping * H;
    for (Eigen::Index i = 0; i < H.size(); ++i) {
      if (!(H[i] > 0)) D[i] = 1;  // no residual depends on it
    }
    if (!solve(D, step).ok) return std::numeric_limits<double>::quiet_NaN();
    clearConstrained(step);
    unseen = unseenUnknowns(step);
    for (const int u : unseen) step[u] = 0;
    return decreaseBy(step);
  };
  for (const double damping : {0.0, 1e-14, 1e-12, 1e-10, 1e-8}) {
    result.decrease = promised(damping, result.step);
    if (!std::isfinite(result.decrease)) continue;
    const std::vector<int> out_of_sight = unseen;
    // If more damping makes a predicted decrease smaller, the decrease without damping would be larger.
    constexpr double more = 100, similar = 1.1;
    Eigen::VectorXd ignored;
    const bool is_similar =
        damping == 0 || result.decrease <= similar * promised(more * damping, ignored) + kRounding * rss_;
    result.is_known = is_similar && std::none_of(out_of_sight.begin(), out_of_sight.end(),
                                                 [this](int u) { return hasRunAway(u); });
    if (result.is_known && carefully && solver_->isExact() && result.decrease <= most)
      lookDeeper(out_of_sight, result);
    break;
  }
  return result;
}

/// Computes the decrease that the linear model predicts along columns so nearly dependent that J^T J does not show it.
/// Factorises J itself, with the smallest damping that suppresses rounding errors. Replaces `promise` if the decrease
/// is a larger fraction of the RSS than rounding can be.
void Evaluator::lookDeeper(const std::vector<int>& out_of_sight, Promise& promise) {
  constexpr double of_the_digits = 0.1, least_pivot = 1e-15, most_rounding = 1e-5;
  if (mustStop()) return;
  const std::unique_ptr<LinearSolver> rows = given_->careful(least_pivot);
  if (rows == nullptr) return;
  rows->analyze(structure_.system);
  linearizer_.linearize(problem_, problem_.activeSet(), *rows);
  const Eigen::VectorXd& H = rows->diagonal();
  Eigen::VectorXd damping = std::pow(of_the_digits * digitsOfDerivatives(problem_), 2) * H;
  for (Eigen::Index i = 0; i < H.size(); ++i) {
    if (!(H[i] > 0)) damping[i] = 1;
  }
  for (const int u : out_of_sight) damping[u] = H.maxCoeff();
  Eigen::VectorXd step;
  if (!rows->solve(damping, step).ok) return;
  clearConstrained(step);
  const double decrease = -rows->gradient().dot(step);
  if (decrease > std::max(promise.decrease, most_rounding * rss_))
    promise = {true, false, decrease, std::move(step)};
}

bool Evaluator::advance(const Promise& promise) {
  constexpr double kept = 0.25;  // fraction of the predicted decrease
  if (!promise.is_known || collective_->all(promise.step.size() == 0)) return false;
  const double before = rss_, after = tryStep(promise.step);
  if (std::isfinite(after) && before - after >= kept * promise.decrease && after < before) return true;
  undo();
  linearize();
  return false;
}

double Evaluator::roundingOfPromises() {
  constexpr double steps = 4;  // units in the last place
  const double effect = collective_->dot(solver_->diagonal().cwiseSqrt(), typicalSizes());
  return std::pow(steps * std::numeric_limits<double>::epsilon() * effect, 2);
}

}  // namespace slom
