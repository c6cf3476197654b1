#include "optimize/graduation.hpp"

#include <algorithm>

namespace slom {

namespace {
/// Relative decrease of the RSS below which a stage is over.
constexpr double kStageTolerance = 1e-3;
}  // namespace

Graduation::Graduation(Evaluator& evaluator, const Options& options)
    : evaluator_(evaluator), options_(options), most_(2 * evaluator.largestLossArgument()) {}

Graduation::~Graduation() {
  if (evaluator_.lossGraduation() != 1) evaluator_.setLossGraduation(1);
}

void Graduation::advance() {
  if (mu_ > 0) most_ = 2 * evaluator_.largestLossArgument();
  mu_ = std::max(mu_ > 0 ? std::min(mu_ / options_.graduation_factor, most_) : most_, 1.0);
  evaluator_.setLossGraduation(mu_);
}

Options Graduation::limits(int iterations, int most) const {
  Options limits = options_;
  limits.max_iterations = most;
  if (isLast()) return limits;
  limits.max_iterations = std::min(most, iterations + options_.stage_iterations);
  limits.decrease_tolerance = std::max(options_.decrease_tolerance, kStageTolerance);
  return limits;
}

}  // namespace slom
