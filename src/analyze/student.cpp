#include "slom/analyze/student.hpp"

#include <cmath>
#include <limits>

#include "analyze/special_functions.hpp"

namespace slom {

namespace {

constexpr double kNormalDof = 1e8;  // beyond, t and the normal distribution agree to 1e-8

/// Returns ln (Gamma(a + 1/2) / Gamma(a)), for a > 0. A recurrence raises a to 40, where the asymptotic series has 15
/// digits.
double logGammaStep(double a) {
  double sum = 0;
  for (; a < 40; ++a) sum -= std::log((a + 0.5) / a);
  const double x = 1 / a;
  return sum + 0.5 * std::log(a) - x / 8 + x * x * x / 192 - x * x * x * x * x / 640;
}

}  // namespace

double studentProbability(double t, double dof) {
  if (!(t > 0)) return 1;
  if (!(dof < kNormalDof)) return std::erfc(t / std::sqrt(2.0));
  // I_x(dof / 2, 1 / 2), x = dof / (dof + t^2)
  const double a = dof / 2, b = 0.5, x = dof / (dof + t * t), y = t * t / (dof + t * t);
  // 1 / B(a, 1/2) = Gamma(a + 1/2) / (Gamma(a) sqrt(pi))
  const double front =
      std::exp(logGammaStep(a) + a * std::log(x) + b * std::log(y)) / std::sqrt(std::acos(-1.0));
  return x < (a + 1) / (a + b + 2) ? front * betaFraction(a, b, x) / a
                                   : 1 - front * betaFraction(b, a, y) / b;
}

double studentCritical(double probability, double dof) {
  double low = 0, high = 2;
  while (studentProbability(high, dof) > probability && high < std::numeric_limits<double>::max() / 4)
    high *= 2;
  for (int i = 0; i < 200 && high - low > 1e-14 * high; ++i) {
    const double middle = (low + high) / 2;
    (studentProbability(middle, dof) > probability ? low : high) = middle;
  }
  return (low + high) / 2;
}

}  // namespace slom
