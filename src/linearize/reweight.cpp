#include "reweight.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace slom {

namespace {

using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kSmallestCurvature = 0.25;

/// Returns the value of the measurement's loss; NaN if s is not finite, so that no bounded loss hides it.
LossValue valueOf(const Loss* loss, double s, double graduation) {
  if (!std::isfinite(s)) return {std::numeric_limits<double>::quiet_NaN(), 1, 0};
  return loss == nullptr ? LossValue{s, 1, 0} : loss->evaluate(s, graduation);
}

/// r~ = of_r r, J~ = of_J (I - k r r^T) J.
struct Factors {
  double of_r = 1;
  double of_J = 1;
  double k = 0;
};

Factors factorsFor(const LossValue& value, double s) {
  const double root = std::sqrt(value.first);
  if (value.second == 0) return {root, root, 0};
  const double bend = 2 * value.second / value.first;  // <= 0
  const double D = 1 + s * bend;
  if (!(D >= kSmallestCurvature)) return {root, root, 0};
  return {root / std::sqrt(D), root, -bend / (1 + std::sqrt(D))};
}

}  // namespace

double robustCost(const MeasurementPool& pool, int first, int last, double graduation, const double* r) {
  double sum = 0;
  for (int i = first; i < last; ++i) {
    const int rows = pool.rows(i);
    sum += valueOf(pool.lossOf(i), Map<const VectorXd>(r, rows).squaredNorm(), graduation).rho;
    r += rows;
  }
  return sum;
}

double reweight(const Problem& problem, const MeasurementPool& pool, int first, int last, double graduation,
                double* r, double* J) {
  double sum = 0;
  for (int i = first; i < last; ++i) {
    const int rows = pool.rows(i);
    Map<VectorXd> residual(r, rows);
    const double s = residual.squaredNorm();
    const LossValue value = valueOf(pool.lossOf(i), s, graduation);
    const Factors factors = factorsFor(value, s);
    sum += value.rho;
    if (factors.of_J == 1 && factors.k == 0) {  // no loss, or Huber's with a small residual: the usual case
      J += static_cast<std::ptrdiff_t>(rows) * pool.columns(i);
      r += rows;
      continue;
    }
    for (int k = 0; k < pool.arity(); ++k) {
      const VariableRecord& variable = problem.variables()[static_cast<std::size_t>(pool.variables(i)[k])];
      Map<MatrixXd> block(J, rows, variable.dof);
      if (problem.activeSet().isOptimized(pool.variables(i)[k])) {
        for (int j = 0; j < variable.dof; ++j) {
          if (factors.k != 0) block.col(j) -= factors.k * residual.dot(block.col(j)) * residual;
          block.col(j) *= factors.of_J;
        }
      }
      J += block.size();
    }
    residual *= factors.of_r;
    r += rows;
  }
  return sum;
}

double largestLossArgument(const MeasurementPool& pool, int first, int last, const double* r) {
  double largest = -1;
  for (int i = first; i < last; ++i) {
    const int rows = pool.rows(i);
    if (const Loss* loss = pool.lossOf(i)) {
      largest =
          std::max(largest, Map<const VectorXd>(r, rows).squaredNorm() / (loss->scale() * loss->scale()));
    }
    r += rows;
  }
  return largest;
}

}  // namespace slom
