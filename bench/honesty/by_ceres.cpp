#include <ceres/ceres.h>

#include "honesty/methods.hpp"

namespace slom::bench {

namespace {

using testing::classics::Problem;

struct Residual {
  const Problem& problem;

  template <class T>
  bool operator()(const T* const* parameters, T* residual) const {
    testing::classics::evaluate<T>(problem, parameters[0], residual);
    return true;
  }
};

constexpr int kMostParameters = 11;

}  // namespace

/// Fits with Ceres' default options, except for the number of iterations, which is SLoM's.
Claim fitByCeres(const Problem& problem, Method method) {
  Claim claim;
  claim.x = problem.start;
  auto* const cost = new ceres::DynamicAutoDiffCostFunction<Residual, kMostParameters>(new Residual{problem});
  cost->AddParameterBlock(static_cast<int>(claim.x.size()));
  cost->SetNumResiduals(problem.residuals);
  ceres::Problem ceres_problem;
  ceres_problem.AddResidualBlock(cost, nullptr, claim.x.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.trust_region_strategy_type = method == Method::dog_leg ? ceres::DOGLEG : ceres::LEVENBERG_MARQUARDT;
  options.max_num_iterations = 10'000;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &ceres_problem, &summary);
  claim.converged = summary.termination_type == ceres::CONVERGENCE;
  claim.iterations = static_cast<int>(summary.iterations.size()) - 1;
  claim.rss = 2 * summary.final_cost;
  return claim;
}

}  // namespace slom::bench
