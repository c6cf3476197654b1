// Bundle adjustment by SLoM, as in the command `slom bundle`.
#include <slom/io/scene_model.hpp>

#include "fit/run.hpp"
#include "fit/slom_options.hpp"
#include "fit/stopwatch.hpp"

namespace slom::bench {

Run fitBySlom(const io::Scene& scene, const Limits& limits) {
  Estimator est;
  est.setThreads(limits.threads);
  est.changeAlgorithm(LevenbergMarquardt(1e-4, 0.1));  // as in the command: points recede from cameras
  const double build = secondsOf([&] { io::insert(est, scene, lossOf(limits)); });
  Run run = runOf(est.optimize(stoppingRule(limits)));
  run.build_seconds = build;
  return run;
}

}  // namespace slom::bench
