#include "nist/by_ceres.hpp"

#include <limits>
#include <vector>

#include <ceres/ceres.h>
#include <glog/logging.h>

namespace slom::bench {

namespace {

using testing::nist::Datum;
using testing::nist::Fit;
using testing::nist::Model;
using testing::nist::Problem;

struct Residual {
  Model model;
  Datum datum;

  template <class T>
  bool operator()(const T* const* parameters, T* residual) const {
    *residual = testing::nist::predict(model, parameters[0], datum.x) - datum.y;
    return true;
  }
};

constexpr int kMostParameters = 9;  // in any problem; derivatives take one pass

ceres::Solver::Options optionsFor(CeresMethod method, double initial_radius) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.trust_region_strategy_type =
      method == CeresMethod::dog_leg ? ceres::DOGLEG : ceres::LEVENBERG_MARQUARDT;
  options.initial_trust_region_radius = initial_radius;
  options.max_num_iterations = testing::nist::toTheLastDigit().max_iterations;
  options.max_num_consecutive_invalid_steps = 100;
  options.function_tolerance = 0;  // finds more digits than epsilon
  options.gradient_tolerance = options.parameter_tolerance = std::numeric_limits<double>::epsilon();
  options.logging_type = ceres::SILENT;
  return options;
}

/// Returns standard deviations; empty if J has no full rank.
Eigen::VectorXd deviations(ceres::Problem& problem, const double* b, Eigen::Index n, double variance) {
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::DENSE_SVD;
  options.min_reciprocal_condition_number = 0;  // columns have their own units, so the number is meaningless
  ceres::Covariance covariance(options);
  if (!covariance.Compute(std::vector<const double*>{b}, &problem)) return {};
  Eigen::MatrixXd C(n, n);
  covariance.GetCovarianceMatrix({b}, C.data());
  return (variance * C.diagonal()).cwiseSqrt();
}

}  // namespace

Fit fitByCeres(const Problem& problem, const Eigen::VectorXd& start, CeresMethod method,
               double initial_radius) {
  Fit fit;
  fit.parameters = start;
  ceres::Problem fitted;
  for (const Datum& datum : problem.data) {
    auto* const cost =
        new ceres::DynamicAutoDiffCostFunction<Residual, kMostParameters>(new Residual{problem.model, datum});
    cost->AddParameterBlock(static_cast<int>(start.size()));
    cost->SetNumResiduals(1);
    fitted.AddResidualBlock(cost, nullptr, fit.parameters.data());
  }
  FLAGS_minloglevel = google::GLOG_ERROR;  // Ceres warns of each rejected step
  ceres::Solver::Summary summary;
  ceres::Solve(optionsFor(method, initial_radius), &fitted, &summary);
  fit.converged = summary.termination_type == ceres::CONVERGENCE;
  fit.iterations = static_cast<int>(summary.iterations.size()) - 1;
  fit.rss = 2 * summary.final_cost;
  fit.deviations = deviations(fitted, fit.parameters.data(), start.size(), fit.rss / problem.redundancy());
  return fit;
}

}  // namespace slom::bench
