/// Robust losses: how much less than its square a large residual counts.
///
///     est.insertMeasurement(Observation(pose, landmark, z), slom::StandardDeviation(0.1), slom::Huber(1.345));
///
/// A measurement with whitened residual W r and s = |W r|^2 then adds rho(s) to the RSS instead of s.
///   scale c        in standard deviations (the length of W r), > 0: below it a residual counts nearly in full
///   normalisation  rho(0) = 0, rho'(0) = 1, rho concave: 0 <= rho'(s) <= 1 is the measurement's weight
/// With t = s / c^2:
///   Huber(c)             t <= 1: c^2 t, else c^2 (2 sqrt(t) - 1)       weight 1, 1 / sqrt(t)
///   PseudoHuber(c)       2 c^2 (sqrt(1 + t) - 1)                       weight 1 / sqrt(1 + t)
///   Cauchy(c)            c^2 log(1 + t)                                weight 1 / (1 + t)
///   GemanMcClure(c)      c^2 t / (1 + t)                               weight 1 / (1 + t)^2
///   Tukey(c)             t <= 1: c^2 (1 - (1 - t)^3) / 3, else c^2/3   weight (1 - t)^2, 0
///   Barron(alpha, c)     2 c^2 b/alpha ((1 + t/b)^(alpha/2) - 1)       weight (1 + t/b)^(-b/2),  b = 2 - alpha >= 0
/// Barron(alpha, c) is 2 c^2 rho(x, alpha, c) of the source: alpha = 2 the square, 1 PseudoHuber(c),
/// 0 Cauchy(sqrt(2) c), -2 GemanMcClure(2 c), -infinity Welsch's loss 2 c^2 (1 - exp(-t/2)).
///   sources  Huber, "Robust statistics", 1981; Holland and Welsch, "Robust regression using iteratively reweighted
///            least-squares", 1977 (for scalar residuals, 95 % efficiency on normal ones: Huber 1.345, Cauchy 2.385,
///            Tukey 4.685); Barron, "A general and adaptive robust loss function", CVPR 2019
#pragma once

#include <compare>
#include <string>
#include <type_traits>

namespace slom {

/// rho and its derivatives by s.
struct LossValue {
  double rho = 0;
  double first = 1;   ///< rho', the weight
  double second = 0;  ///< rho''
};

/// Which loss, with its numbers. `Loss()` is none: rho(s) = s.
class Loss {
 public:
  enum class Kind : unsigned char { none, huber, pseudo_huber, cauchy, tukey, geman_mcclure, barron };

  constexpr Loss() = default;

  Kind kind() const { return kind_; }
  double scale() const { return scale_; }
  /// Barron's alpha; 0 for the others.
  double shape() const { return shape_; }

  /// At s >= 0, finite, with the scale c sqrt(graduation).
  LossValue evaluate(double s, double graduation = 1) const;
  /// `Huber(1.345)`, `Barron(-2, 1.5)`, `none`.
  std::string text() const;

  auto operator<=>(const Loss&) const = default;

 protected:
  constexpr Loss(Kind kind, double scale, double shape = 0) : kind_(kind), scale_(scale), shape_(shape) {}

 private:
  Kind kind_ = Kind::none;
  double scale_ = 1;
  double shape_ = 0;
};

struct Huber : Loss {
  explicit constexpr Huber(double scale) : Loss(Kind::huber, scale) {}
};
struct PseudoHuber : Loss {
  explicit constexpr PseudoHuber(double scale) : Loss(Kind::pseudo_huber, scale) {}
};
struct Cauchy : Loss {
  explicit constexpr Cauchy(double scale) : Loss(Kind::cauchy, scale) {}
};
struct Tukey : Loss {
  explicit constexpr Tukey(double scale) : Loss(Kind::tukey, scale) {}
};
struct GemanMcClure : Loss {
  explicit constexpr GemanMcClure(double scale) : Loss(Kind::geman_mcclure, scale) {}
};
/// `alpha` <= 2; -infinity is allowed.
struct Barron : Loss {
  constexpr Barron(double alpha, double scale) : Loss(Kind::barron, scale, alpha) {}
};

template <class T>
concept IsLoss = std::is_base_of_v<Loss, T>;

namespace detail {
/// What is wrong with the loss's numbers, `has scale -1; pass ...`; empty when nothing is.
std::string faultOf(const Loss& loss);
[[noreturn]] void raiseLossError(const Loss& loss, const std::string& fault, const std::string& subject);
}  // namespace detail

/// Throws [slom.bad-loss], naming `subject()`, which is called only then.
template <class Subject>
void checkLoss(const Loss& loss, Subject&& subject) {
  if (const std::string fault = detail::faultOf(loss); !fault.empty())
    detail::raiseLossError(loss, fault, subject());
}

}  // namespace slom
