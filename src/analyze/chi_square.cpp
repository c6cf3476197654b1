#include "slom/analyze/chi_square.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "analyze/special_functions.hpp"

namespace slom {

namespace {

constexpr int kMostTerms = 100000;
constexpr double kEpsilon = 1e-16;

/// Returns P(a, x) by its power series, for x < a + 1.
double lowerBySeries(double a, double x) {
  double term = 1 / a, sum = term;
  for (int n = 1; n < kMostTerms && term > kEpsilon * sum; ++n) {
    term *= x / (a + n);
    sum += term;
  }
  return sum * std::exp(a * std::log(x) - x - logGamma(a));
}

/// Returns Q(a, x) by its continued fraction (Lentz's evaluation), for x >= a + 1.
double upperByFraction(double a, double x) {
  constexpr double tiny = 1e-300;
  double b = x + 1 - a, c = 1 / tiny, d = 1 / b, product = d;
  for (int n = 1; n < kMostTerms; ++n) {
    const double numerator = -n * (n - a);
    b += 2;
    d = numerator * d + b;
    c = b + numerator / c;
    d = 1 / (std::abs(d) < tiny ? tiny : d);
    if (std::abs(c) < tiny) c = tiny;
    product *= d * c;
    if (std::abs(d * c - 1) < kEpsilon * 10) break;
  }
  return product * std::exp(a * std::log(x) - x - logGamma(a));
}

}  // namespace

double chiSquareProbability(double x, double dof) {
  if (!(x > 0)) return 1;
  if (std::isinf(x)) return 0;
  const double a = dof / 2, half = x / 2;
  return half < a + 1 ? 1 - lowerBySeries(a, half) : upperByFraction(a, half);
}

double chiSquareCritical(double probability, double dof) {
  double low = 0, high = dof + 10;
  while (chiSquareProbability(high, dof) > probability) high *= 2;
  for (int i = 0; i < 200 && high - low > 1e-14 * high; ++i) {
    const double middle = (low + high) / 2;
    (chiSquareProbability(middle, dof) > probability ? low : high) = middle;
  }
  return (low + high) / 2;
}

}  // namespace slom
