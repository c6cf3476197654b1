#include "fit/run.hpp"

#include <algorithm>
#include <limits>

namespace slom::bench {

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Run runOf(const Summary& summary) {
  Run run;
  run.solver = summary.algorithm + ", " + summary.solver;
  run.converged = summary.converged;
  run.iterations = summary.iterations;
  run.seconds = summary.seconds;
  run.setup_seconds = summary.phases.setup;
  run.linearize_seconds = summary.phases.linearize;
  run.factor_seconds = summary.phases.factorize;
  run.solve_seconds = summary.phases.solve;
  std::vector<double> durations;
  for (const IterationRecord& record : summary.trace) {
    if (!run.trace.empty()) durations.push_back(record.seconds - run.trace.back().seconds);
    run.trace.push_back({record.seconds, record.rss});
    run.factorizations += record.trials;
  }
  run.iteration_seconds = median(durations);
  return run;
}

double Run::secondsUntil(double best, double tolerance) const {
  for (const TracePoint& point : trace) {
    if (point.rss <= best * (1 + tolerance)) return point.seconds;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace slom::bench
