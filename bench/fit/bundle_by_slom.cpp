// Bundle adjustment by SLoM, as the command `slom bundle` does it.
#include <memory>

#include "bundle/fit/fit.hpp"
#include "fit/run.hpp"
#include "fit/slom_options.hpp"
#include "fit/stopwatch.hpp"

namespace slom::bench {

Run fitBySlom(const app::bundle::Scene& scene, const Limits& limits) {
  const app::FitOptions options = fitOptions(limits, app::AlgorithmName::lm);
  std::unique_ptr<app::bundle::BundleFit> fit;
  const double build = secondsOf([&] { fit = std::make_unique<app::bundle::BundleFit>(scene, options); });
  Run run = runOf(fit->optimize(stoppingRule(limits)));
  run.build_seconds = build;
  return run;
}

}  // namespace slom::bench
