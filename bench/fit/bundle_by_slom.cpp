// Bundle adjustment by SLoM, as the command `slom bundle` does it.
#include "bundle/fit/fit.hpp"

#include "fit/run.hpp"

namespace slom::bench {

Run fitBySlom(const app::bundle::Scene& scene, const Limits& limits) {
  app::FitOptions settings;
  settings.algorithm = app::AlgorithmName::lm;
  settings.threads = limits.threads;
  app::bundle::BundleFit fit(scene, settings);
  Options options;
  options.max_iterations = limits.max_iterations;
  return runOf(fit.optimize(options));
}

}  // namespace slom::bench
