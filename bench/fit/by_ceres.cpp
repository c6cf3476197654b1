#include <ceres/ceres.h>

#include "fit/ceres_problem.hpp"

namespace slom::bench {

Run solveByCeres(CeresProblem& problem, ceres::LinearSolverType solver, const Limits& limits) {
  ceres::Solver::Options options;
  options.linear_solver_type = solver;
  options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  options.num_threads = limits.threads;
  options.max_num_iterations = limits.max_iterations;
  options.function_tolerance = 1e-12;
  options.gradient_tolerance = 1e-14;
  options.parameter_tolerance = 1e-14;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem.problem, &summary);
  Run run;
  run.program = std::string("Ceres, ") + ceres::LinearSolverTypeToString(solver);
  run.iterations = static_cast<int>(summary.iterations.size()) - 1;
  run.setup_seconds = summary.preprocessor_time_in_seconds;
  run.seconds = summary.total_time_in_seconds;
  run.factor_seconds = summary.linear_solver_time_in_seconds;
  double best = 2 * summary.initial_cost;
  for (const ceres::IterationSummary& iteration : summary.iterations) {
    best = std::min(best, 2 * (iteration.cost + summary.fixed_cost));
    run.trace.push_back({iteration.cumulative_time_in_seconds + summary.preprocessor_time_in_seconds, best});
  }
  run.solver = ceres::LinearSolverTypeToString(summary.linear_solver_type_used);
  return run;
}

}  // namespace slom::bench
