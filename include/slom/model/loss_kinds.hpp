/// The robust losses of the library, at scale 1: phi(t) and its derivatives. loss.hpp has the formulas as a table, and
/// the classes that users pass.
#pragma once

#include <cmath>

#include "mtk/detail/cpp20.hpp"

namespace slom {

/// rho and its derivatives with respect to s.
struct LossValue {
  double rho = 0;
  double first = 1;   ///< rho', the weight
  double second = 0;  ///< rho''
};

/// Common properties of all losses of one name.
struct LossKind {
  const char* name;  ///< `GemanMcClure`
  /// `geman-mcclure`, the name in archives and options of slom; null for losses that a program defines.
  const char* stored_name;
  bool has_shape;
  /// Returns phi(t), phi'(t), phi''(t) at scale 1, where s = t.
  LossValue (*evaluate)(double t, double shape);
};

namespace detail::losses {

inline LossValue huber(double t, double) {
  if (t <= 1) return {t, 1, 0};
  const double root = std::sqrt(t);
  return {2 * root - 1, 1 / root, -0.5 / (t * root)};
}
inline constexpr LossKind Huber{"Huber", "huber", false, &huber};

inline LossValue pseudoHuber(double t, double) {
  const double root = std::sqrt(1 + t);
  return {2 * t / (root + 1), 1 / root, -0.5 / ((1 + t) * root)};
}
inline constexpr LossKind PseudoHuber{"PseudoHuber", "pseudo-huber", false, &pseudoHuber};

inline LossValue cauchy(double t, double) {
  const double weight = 1 / (1 + t);
  return {std::log1p(t), weight, -weight * weight};
}
inline constexpr LossKind Cauchy{"Cauchy", "cauchy", false, &cauchy};

inline LossValue tukey(double t, double) {
  if (t >= 1) return {1.0 / 3, 0, 0};
  return {t * (1 - t * (1 - t / 3)), (1 - t) * (1 - t), -2 * (1 - t)};
}
inline constexpr LossKind Tukey{"Tukey", "tukey", false, &tukey};

inline LossValue gemanMcClure(double t, double) {
  const double root = 1 / (1 + t);  // square root of the weight
  return {t * root, root * root, -2 * root * root * root};
}
inline constexpr LossKind GemanMcClure{"GemanMcClure", "geman-mcclure", false, &gemanMcClure};

/// Value of b = 2 - alpha beyond which Barron's loss equals Welsch's to all digits.
inline constexpr double kLeastOfWelsch = 1e100;

inline LossValue barron(double t, double alpha) {
  const double b = 2 - alpha;
  if (b == 0) return {t, 1, 0};
  if (b > kLeastOfWelsch) {
    const double weight = std::exp(-t / 2);
    return {-2 * std::expm1(-t / 2), weight, -weight / 2};
  }
  const double log = std::log1p(t / b);
  const double weight = std::exp(-b / 2 * log);
  // phi = 2 b/alpha ((1 + t/b)^(alpha/2) - 1), in one form for each end of the range. For small b, the power is t/b
  // times the weight. For alpha around 0, the quotient tends to the logarithm.
  const double x = alpha / 2 * log;
  const double phi = alpha >= 1 ? 2 / alpha * (t * weight + b * std::expm1(-b / 2 * log))
                                : b * log * (x == 0 ? 1 : std::expm1(x) / x);
  return {phi, weight, -weight / 2 * (b / (b + t))};
}
inline constexpr LossKind Barron{"Barron", "barron", true, &barron};

}  // namespace detail::losses

}  // namespace slom
