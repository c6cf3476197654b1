#include "optimize/options.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/words.hpp"
#include "mtk/error.hpp"

namespace slom {

using mtk::Error;

namespace {

void checkGraduation(const Options& options) {
  if (!(options.graduation_factor > 1 && std::isfinite(options.graduation_factor))) {
    throw Error("slom.bad-option",
                "graduation_factor is " + number(options.graduation_factor, 6) +
                    "; pass a finite number above 1, such as 1.4",
                "graduation_factor");
  }
  if (options.stage_iterations < 1) {
    throw Error("slom.bad-option",
                "stage_iterations is " + std::to_string(options.stage_iterations) +
                    "; pass a positive number, such as 2",
                "stage_iterations");
  }
}

void checkLimits(const Options& options) {
  if (options.max_iterations < 0 && options.max_iterations != Options::kByTheSize) {
    throw Error("slom.bad-option",
                "max_iterations is " + std::to_string(options.max_iterations) +
                    "; pass 0 or more, or Options::kByTheSize",
                "max_iterations");
  }
  if (!(options.max_seconds > 0)) {
    throw Error("slom.bad-option",
                "max_seconds is " + number(options.max_seconds, 6) + "; pass a positive number",
                "max_seconds");
  }
  const std::pair<const char*, double> tolerances[] = {{"gradient_tolerance", options.gradient_tolerance},
                                                       {"decrease_tolerance", options.decrease_tolerance},
                                                       {"step_tolerance", options.step_tolerance}};
  for (const auto& [name, tolerance] : tolerances) {
    if (tolerance >= 0) continue;
    throw Error("slom.bad-option",
                std::string(name) + " is " + number(tolerance, 6) + "; pass 0 or more, such as 1e-10", name);
  }
  if (!(options.deviation_tolerance >= 0)) {
    throw Error("slom.bad-option",
                "deviation_tolerance is " + number(options.deviation_tolerance, 6) +
                    "; pass 0 or more, such as 1e-8, or infinity for none",
                "deviation_tolerance");
  }
}

}  // namespace

void requireValid(const Options& options) {
  checkLimits(options);
  checkGraduation(options);
}

int iterationLimit(const Options& options, int unknowns) {
  constexpr int work = 100'000, least = 100, most = 10'000;
  return options.max_iterations == Options::kByTheSize ? std::clamp(work / std::max(1, unknowns), least, most)
                                                       : options.max_iterations;
}

}  // namespace slom
