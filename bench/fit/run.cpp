#include "fit/run.hpp"

#include <limits>

namespace slom::bench {

Run runOf(const Summary& summary) {
  Run run;
  run.program = "SLoM";
  run.iterations = summary.iterations;
  run.seconds = summary.seconds;
  run.setup_seconds = summary.phases.setup;
  run.factor_seconds = summary.phases.factorize;
  run.solver = summary.solver;
  for (const IterationRecord& record : summary.trace) run.trace.push_back({record.seconds, record.rss});
  return run;
}

double Run::secondsUntil(double best, double tolerance) const {
  for (const TracePoint& point : trace) {
    if (point.rss <= best * (1 + tolerance)) return point.seconds;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace slom::bench
