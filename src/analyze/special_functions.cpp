#include "analyze/special_functions.hpp"

#include <cmath>

#include "slom/analyze/chi_square.hpp"

namespace slom {

// In C libraries with lgamma_r, lgamma writes to a variable shared by all threads.
double logGamma(double a) {
#ifdef _WIN32
  return std::lgamma(a);
#else
  int sign = 0;
  return ::lgamma_r(a, &sign);
#endif
}

// Evaluates the fraction by Lentz's method; converges fast for x < (a + 1) / (a + b + 2).
double betaFraction(double a, double b, double x) {
  constexpr int most_terms = 100000;
  constexpr double tiny = 1e-300, epsilon = 1e-16;
  double c = 1, d = 1 - (a + b) * x / (a + 1);
  d = 1 / (std::abs(d) < tiny ? tiny : d);
  double product = d;
  for (int m = 1; m < most_terms; ++m) {
    const auto step = [&](double numerator) {
      d = 1 + numerator * d;
      c = 1 + numerator / c;
      d = 1 / (std::abs(d) < tiny ? tiny : d);
      if (std::abs(c) < tiny) c = tiny;
      product *= d * c;
    };
    step(m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)));
    step(-(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1)));
    if (std::abs(d * c - 1) < 10 * epsilon) break;
  }
  return product;
}

double fProbability(double f, double p, double q) {
  constexpr double many = 1e8;  // from here on, F times p is chi-square to 1e-8
  if (!(f > 0)) return 1;
  if (std::isinf(f)) return 0;
  if (!(q < many)) return chiSquareProbability(p * f, p);
  const double a = q / 2, b = p / 2, x = q / (q + p * f), y = p * f / (q + p * f);
  const double front =
      std::exp(logGamma(a + b) - logGamma(a) - logGamma(b) + a * std::log(x) + b * std::log(y));
  return x < (a + 1) / (a + b + 2) ? front * betaFraction(a, b, x) / a
                                   : 1 - front * betaFraction(b, a, y) / b;
}

}  // namespace slom
