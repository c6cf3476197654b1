#include <cmath>

#include "slom/model/loss.hpp"

namespace slom {

namespace {

/// Value of b = 2 - alpha beyond which Barron's loss equals Welsch's to all digits.
constexpr double kWelsch = 1e100;

LossValue welsch(double t) {
  const double weight = std::exp(-t / 2);
  return {-2 * std::expm1(-t / 2), weight, -weight / 2};
}

LossValue barron(double t, double alpha) {
  const double b = 2 - alpha;
  if (b == 0) return {t, 1, 0};
  if (b > kWelsch) return welsch(t);
  const double log = std::log1p(t / b);
  const double weight = std::exp(-b / 2 * log);
  // phi = 2 b/alpha ((1 + t/b)^(alpha/2) - 1), in one form for each end of the range. For small b, the power is t/b
  // times the weight. For alpha around 0, the quotient tends to the logarithm.
  const double x = alpha / 2 * log;
  const double phi = alpha >= 1 ? 2 / alpha * (t * weight + b * std::expm1(-b / 2 * log))
                                : b * log * (x == 0 ? 1 : std::expm1(x) / x);
  return {phi, weight, -weight / 2 * (b / (b + t))};
}

}  // namespace

const LossKind detail::losses::Barron{"Barron", "barron", true, &barron};

}  // namespace slom
