#include <ceres/ceres.h>

#include "fit/ceres_problem.hpp"

namespace slom::bench {

namespace {

ceres::Solver::Options optionsFor(CeresProblem& problem, ceres::LinearSolverType solver,
                                  const Limits& limits) {
  ceres::Solver::Options options;
  options.linear_solver_type = solver;
  options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  options.preconditioner_type = ceres::SCHUR_JACOBI;
  options.num_threads = limits.threads;
  options.max_num_iterations = limits.max_iterations;
  options.function_tolerance = kDecreaseTolerance;
  options.gradient_tolerance = options.parameter_tolerance = kOtherTolerances;
  options.logging_type = ceres::SILENT;
  if (problem.eliminated_first.empty()) return options;
  const auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  std::vector<double*> all;
  problem.problem.GetParameterBlocks(&all);
  for (double* const block : all) ordering->AddElementToGroup(block, 1);
  for (double* const block : problem.eliminated_first) ordering->AddElementToGroup(block, 0);
  options.linear_solver_ordering = ordering;
  return options;
}

}  // namespace

Run solveByCeres(CeresProblem& problem, ceres::LinearSolverType solver, const Limits& limits) {
  ceres::Solver::Summary summary;
  ceres::Solve(optionsFor(problem, solver, limits), &problem.problem, &summary);
  Run run;
  run.solver = ceres::LinearSolverTypeToString(summary.linear_solver_type_used);
  run.converged = summary.termination_type == ceres::CONVERGENCE;
  run.iterations = static_cast<int>(summary.iterations.size()) - 1;
  run.seconds = summary.total_time_in_seconds;
  run.setup_seconds = summary.preprocessor_time_in_seconds;
  run.linearize_seconds =
      summary.residual_evaluation_time_in_seconds + summary.jacobian_evaluation_time_in_seconds;
  run.factor_seconds = summary.linear_solver_time_in_seconds;
  run.factorizations = run.iterations;
  double best = 2 * summary.initial_cost;
  std::vector<double> durations;
  for (const ceres::IterationSummary& iteration : summary.iterations) {
    best = std::min(best, 2 * (iteration.cost + summary.fixed_cost));
    run.trace.push_back({iteration.cumulative_time_in_seconds + summary.preprocessor_time_in_seconds, best});
    if (iteration.iteration > 0 && iteration.step_is_successful)
      durations.push_back(iteration.iteration_time_in_seconds);
  }
  run.iteration_seconds = median(durations);
  return run;
}

}  // namespace slom::bench
