#include "analyze/variance/series_variance.hpp"

#include <algorithm>
#include <cmath>

namespace slom {

namespace {

using Eigen::Index;

constexpr double kMostCorrelation = 0.95;
/// Constants of the degrees of freedom n / (kLoss + kLossByCorrelation (tau - 1)), tau = (1 + rho) / (1 - rho). They
/// were chosen in simulations so that intervals hold (docs/decisions/clustered_order.md). For many numbers the
/// variance of rho alone would give 3 and 2.
constexpr double kLoss = 1.5, kLossByCorrelation = 4;

/// Expectations for n numbers with this correlation and variance 1, after their mean was subtracted.
struct Expectation {
  double of_sum = 1;      // variance of the sum over n
  double square = 0;      // mean square, times n
  double successive = 0;  // sum of products of successive numbers

  Expectation(double rho, Index n) {
    const auto count = static_cast<double>(n);
    // Row i gets the row sum of rho^|i - j|, over n.
    const auto row = [&](Index i) {
      if (rho == 0) return 1 / count;
      return ((1 - std::pow(rho, static_cast<double>(i + 1))) / (1 - rho) +
              (1 - std::pow(rho, static_cast<double>(n - i))) / (1 - rho) - 1) /
             count;
    };
    double all = 0, between = 0;
    for (Index i = 0; i < n; ++i) {
      all += row(i);
      if (i + 1 < n) between += row(i) + row(i + 1);
    }
    of_sum = all;
    square = count - of_sum;
    successive = (count - 1) * (rho + of_sum / count) - between;
  }
  double correlation() const { return successive / square; }
};

}  // namespace

SeriesVariance seriesVariance(const Eigen::VectorXd& series) {
  const Index n = series.size();
  SeriesVariance result;
  result.dof = static_cast<double>(n - 1);
  const double square = series.squaredNorm();
  if (n < 3 || !(square > 0)) return result;
  const double observed = series.head(n - 1).dot(series.tail(n - 1)) / square;
  double low = 0, high = kMostCorrelation;
  if (observed <= Expectation(low, n).correlation()) {
    high = low;
  } else if (observed >= Expectation(high, n).correlation()) {
    low = high;
  }
  while (high - low > 1e-9) {
    const double middle = (low + high) / 2;
    (Expectation(middle, n).correlation() < observed ? low : high) = middle;
  }
  result.correlation = (low + high) / 2;
  const Expectation expected(result.correlation, n);
  const auto count = static_cast<double>(n);
  result.factor = expected.of_sum * (count - 1) / expected.square;
  const double tau = (1 + result.correlation) / (1 - result.correlation);
  result.dof = std::clamp(count / (kLoss + kLossByCorrelation * (tau - 1)), 1.0, count - 1);
  return result;
}

}  // namespace slom
