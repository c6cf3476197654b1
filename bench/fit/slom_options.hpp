/// Common parts of the fits by SLoM.
#pragma once

#include <slom/model/loss.hpp>
#include <slom/optimize/summary.hpp>

#include "fit/run.hpp"

namespace slom::bench {

inline Loss lossOf(const Limits& limits) { return limits.huber > 0 ? Loss(Huber(limits.huber)) : Loss(); }

inline Options stoppingRule(const Limits& limits) {
  Options options;
  options.max_iterations = limits.max_iterations;
  options.decrease_tolerance = kDecreaseTolerance;
  options.gradient_tolerance = options.step_tolerance = kOtherTolerances;
  return options;
}

}  // namespace slom::bench
