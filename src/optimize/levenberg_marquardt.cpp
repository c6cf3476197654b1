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
constexpr double kLargestDamping = 1e32;
/// Fraction of the first damping below which a step is likely to be taken: only good steps lower the damping so far.
constexpr double kLikelyDamping = 0.125;
constexpr double kHardlyDamped = 1;
}  // namespace

Eigen::Map<const Eigen::VectorXd> ColumnScaling::update(Evaluator& evaluator, double memory) {
  const Eigen::VectorXd& diagonal = evaluator.solver().diagonal();
  const auto size = static_cast<std::size_t>(diagonal.size());
  if (largest_.size() != size || structure_revision_ != evaluator.problem().structureRevision()) {
    structure_revision_ = evaluator.problem().structureRevision();
    largest_.assign(diagonal.begin(), diagonal.end());
    scale_.resize(size);
  }
  for (std::size_t i = 0; i < size; ++i) {
    largest_[i] = std::max(memory * largest_[i], diagonal[static_cast<Eigen::Index>(i)]);
    // An unknown that no measurement depends on gets 1, so that damping holds it where it is.
    scale_[i] = largest_[i] > 0 ? largest_[i] : 1.0;
  }
  return {scale_.data(), diagonal.size()};
}

LevenbergMarquardt::LevenbergMarquardt(double initial_damping, double memory)
    : initial_damping_(initial_damping), memory_(memory), mu_(initial_damping) {
  if (!(initial_damping > 0 && std::isfinite(initial_damping))) {
    throw mtk::Error("slom.bad-option",
                     "the initial damping of LevenbergMarquardt is " + number(initial_damping, 6) +
                         "; pass a positive number",
                     "initial_damping");
  }
  if (!(memory >= 0 && memory <= 1)) {
    throw mtk::Error("slom.bad-option",
                     "the memory of LevenbergMarquardt is " + number(memory, 6) +
                         "; pass a number from 0 (scales of the present linearisation) to 1 (the "
                         "largest so far)",
                     "memory");
  }
}

void LevenbergMarquardt::reset() {
  mu_ = initial_damping_;
  nu_ = 2;
  scales_.reset();
}

std::string LevenbergMarquardt::name() const { return "Levenberg-Marquardt"; }
std::unique_ptr<Algorithm> LevenbergMarquardt::clone() const {
  return std::make_unique<LevenbergMarquardt>(*this);
}

StepOutcome LevenbergMarquardt::step(Evaluator& evaluator, const Options& options) {
  StepOutcome outcome;
  outcome.rss_before = outcome.rss_after = evaluator.linearize();
  const auto D = scales_.update(evaluator, memory_);
  bool was_finite = true;
  for (outcome.trials = 1;; ++outcome.trials) {
    if (outcome.trials > 1 && evaluator.mustStop()) {
      outcome.kind = StepOutcome::Kind::stopped;
      return outcome;
    }
    outcome.damping = mu_;
    const Eigen::VectorXd damping = mu_ * D;
    outcome.status = evaluator.solveDamped(damping, outcome.step);
    if (outcome.status.ok) {
      outcome.predicted_decrease = evaluator.predictedDecrease(outcome.step, damping);
      const bool is_likely = outcome.trials == 1 && mu_ < kLikelyDamping * initial_damping_;
      const double rss = is_likely ? evaluator.tryLikelyStep(outcome.step) : evaluator.tryStep(outcome.step);
      const double decrease = outcome.rss_before - rss;
      was_finite = std::isfinite(rss);
      // With first estimates, the gradient is not that of the RSS. The RSS may rise by up to the step's predicted
      // decrease.
      const bool may_rise =
          evaluator.hasFirstEstimates() && decrease <= 0 && decrease >= -outcome.predicted_decrease;
      const bool is_judged = !may_rise && (!evaluator.mayBeRounding(decrease) ||
                                           !evaluator.mayBeRounding(outcome.predicted_decrease));
      const bool is_noise = !is_judged && std::abs(decrease) <= Evaluator::kNoise * outcome.rss_before;
      const bool is_better =
          (decrease > 0 && !is_noise) ||
          (was_finite && !is_judged && evaluator.cameCloser(damping, outcome.predicted_decrease));
      const bool is_candidate = is_better && outcome.predicted_decrease > 0;
      if (is_candidate && !evaluator.hasFiniteDerivatives()) was_finite = false;
      if (is_candidate && was_finite) {
        const double rho = is_judged ? decrease / outcome.predicted_decrease : 1;
        mu_ *= std::max(1.0 / 3, 1 - std::pow(2 * rho - 1, 3));
        nu_ = 2;
        outcome.rss_after = rss;
        return outcome;
      }
      evaluator.undo();
      evaluator.linearize();
      const bool at_rest =
          was_finite && (outcome.predicted_decrease <= Evaluator::kNothing * outcome.rss_before ||
                         (outcome.trials == 1 && mu_ < kHardlyDamped &&
                          evaluator.isNearlyNothing(outcome.predicted_decrease, options)));
      if (at_rest || evaluator.isNegligible(outcome.step, options.step_tolerance)) {
        outcome.kind = StepOutcome::Kind::stuck;
        return outcome;
      }
    }
    mu_ *= nu_;
    nu_ *= 2;
    if (mu_ > kLargestDamping) {
      reset();
      outcome.kind = !outcome.status.ok ? StepOutcome::Kind::singular
                     : was_finite       ? StepOutcome::Kind::stuck
                                        : StepOutcome::Kind::not_finite;
      return outcome;
    }
  }
}

const NamedAlgorithm detail::algorithms::levenberg_marquardt{"lm", "Levenberg-Marquardt",
                                                             &makeAlgorithm<LevenbergMarquardt>};

}  // namespace slom
