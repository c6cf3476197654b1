/// What the fits by SLoM have in common.
#pragma once

#include <slom/model/loss.hpp>
#include <slom/optimize/summary.hpp>

#include "fit/run.hpp"
#include "fitting/fit_options.hpp"

namespace slom::bench {

inline app::FitOptions fitOptions(const Limits& limits, app::AlgorithmName algorithm) {
  app::FitOptions options;
  options.algorithm = algorithm;
  options.threads = limits.threads;
  if (limits.huber > 0) options.loss = Huber(limits.huber);
  return options;
}

inline Options stoppingRule(const Limits& limits) {
  Options options;
  options.max_iterations = limits.max_iterations;
  options.decrease_tolerance = kDecreaseTolerance;
  options.gradient_tolerance = options.step_tolerance = kOtherTolerances;
  return options;
}

}  // namespace slom::bench
