#include <algorithm>
#include <cmath>
#include <string>

#include "base/words.hpp"
#include "mtk/error.hpp"
#include "optimize/named_list.hpp"
#include "slom/optimize/algorithm.hpp"
#include "slom/optimize/evaluator.hpp"

namespace slom {

namespace {

using Eigen::VectorXd;

constexpr int kMostTrials = 200;  // halving a radius that often reduces it to nothing

/// Returns the point at distance `radius` on the dog leg from 0 over `cauchy` to `newton` (all in scaled unknowns).
VectorXd dogLegPoint(const Evaluator& evaluator, const VectorXd& cauchy, const VectorXd& newton,
                     double radius) {
  if (evaluator.norm(newton) <= radius) return newton;
  const double shortest = evaluator.norm(cauchy);
  if (shortest >= radius) return cauchy * (radius / shortest);
  // The formula for |cauchy + beta (newton - cauchy)| = radius avoids cancellation.
  const VectorXd leg = newton - cauchy;
  const double c = evaluator.dot(cauchy, leg), a = evaluator.squaredNorm(leg);
  const double gap = radius * radius - evaluator.squaredNorm(cauchy);
  const double root = std::sqrt(c * c + a * gap);
  const double beta = c <= 0 ? (root - c) / a : gap / (c + root);
  return cauchy + beta * leg;
}

/// Solves with the smallest of some dampings, relative to the scales, that has a solution.
SolveStatus leastDamped(Evaluator& evaluator, const VectorXd& scale, VectorXd& step) {
  SolveStatus status;
  for (const double damping : {1e-12, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2}) {
    status = evaluator.solveDamped(damping * scale.cwiseAbs2(), step);
    if (status.ok) break;
  }
  return status;
}

}  // namespace

DogLeg::DogLeg(double initial_radius) : initial_radius_(initial_radius), radius_(initial_radius) {
  if (initial_radius >= 0 && std::isfinite(initial_radius)) return;
  throw mtk::Error("slom.bad-option",
                   "the initial radius of DogLeg is " + number(initial_radius, 6) +
                       "; pass a positive number, or 0 for the length of the first Gauss-Newton step",
                   "initial_radius");
}

void DogLeg::reset() {
  radius_ = initial_radius_;
  scales_.reset();
}

std::string DogLeg::name() const { return "dog leg"; }
std::unique_ptr<Algorithm> DogLeg::clone() const { return std::make_unique<DogLeg>(*this); }

StepOutcome DogLeg::step(Evaluator& evaluator, const Options& options) {
  StepOutcome outcome;
  outcome.rss_before = outcome.rss_after = evaluator.linearize();
  const VectorXd scale = scales_.update(evaluator).cwiseSqrt();
  VectorXd newton;
  outcome.status = evaluator.solveUndamped(newton);
  // A problem with full rank at the start (so the radius is known) may lose rank on the way and regain it. The status
  // still reports the loss, so no convergence is claimed there.
  const bool is_regularized = !outcome.status.ok && radius_ > 0 && !(initial_radius_ > 0);
  if (!outcome.status.ok && !(is_regularized && leastDamped(evaluator, scale, newton).ok)) {
    outcome.kind = StepOutcome::Kind::singular;
    outcome.trials = 1;
    return outcome;
  }
  const double promised = evaluator.predictedDecrease(newton, {});
  newton = newton.cwiseProduct(scale);
  const VectorXd gradient = evaluator.solver().gradient().cwiseQuotient(scale);
  const double curvature = evaluator.solver().squaredNormOfJd(gradient.cwiseQuotient(scale));
  const VectorXd cauchy = curvature > 0 ? VectorXd(-(evaluator.squaredNorm(gradient) / curvature) * gradient)
                                        : VectorXd(0 * gradient);
  if (!(radius_ > 0)) radius_ = evaluator.norm(newton);

  for (outcome.trials = 1;; ++outcome.trials) {
    if (outcome.trials > 1 && evaluator.mustStop()) {
      outcome.kind = StepOutcome::Kind::stopped;
      return outcome;
    }
    outcome.damping = radius_;
    const VectorXd scaled = dogLegPoint(evaluator, cauchy, newton, radius_);
    outcome.step = scaled.cwiseQuotient(scale);
    outcome.predicted_decrease = evaluator.predictedDecrease(outcome.step);
    outcome.is_undamped =
        evaluator.collective().all(evaluator.solver().isExact() && !is_regularized && scaled == newton);
    // If rounding hides the RSS, closeness is measured with the damping that gives steps of about this length.
    VectorXd damping;
    double promised_damped = promised;
    if (!outcome.is_undamped && evaluator.mayBeRounding(outcome.predicted_decrease)) {
      damping = evaluator.norm(gradient) / radius_ * scale.cwiseAbs2();
      VectorXd ignored;
      if (evaluator.solveDamped(damping, ignored).ok)
        promised_damped = evaluator.predictedDecrease(ignored, damping);
    }
    const double rss = evaluator.tryStep(outcome.step);
    bool finite = std::isfinite(rss);
    const double decrease = outcome.rss_before - rss;
    const bool is_judged =
        !evaluator.mayBeRounding(decrease) || !evaluator.mayBeRounding(outcome.predicted_decrease);
    const bool is_noise = !is_judged && std::abs(decrease) <= Evaluator::kNoise * outcome.rss_before;
    bool is_better = finite && ((decrease > 0 && !is_noise) ||
                                (!is_judged && evaluator.cameCloser(damping, promised_damped)));
    if (is_better && !evaluator.hasFiniteDerivatives()) is_better = finite = false;
    const double rho = !finite ? -1 : is_judged ? decrease / outcome.predicted_decrease : is_better ? 1 : 0;
    const double length = evaluator.norm(scaled);
    if (rho > 0.75) {
      radius_ = std::max(radius_, 3 * length);
    } else if (!(rho >= 0.25)) {
      radius_ = std::min(length, radius_) / 2;  // radius / 2 if the norm is not a number
    }
    if (is_better) {
      outcome.rss_after = rss;
      return outcome;
    }
    evaluator.undo();
    evaluator.linearize();
    const bool at_rest = finite && (outcome.predicted_decrease <= Evaluator::kNothing * outcome.rss_before ||
                                    (outcome.is_undamped && evaluator.isNearlyNothing(promised, options)));
    if (at_rest || outcome.trials >= kMostTrials ||
        evaluator.isNegligible(outcome.step, options.step_tolerance)) {
      outcome.kind = finite ? StepOutcome::Kind::stuck : StepOutcome::Kind::not_finite;
      return outcome;
    }
  }
}

const NamedAlgorithm detail::algorithms::dog_leg{"dogleg", "Powell's dog leg", &makeAlgorithm<DogLeg>};

}  // namespace slom
