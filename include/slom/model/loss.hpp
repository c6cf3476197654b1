/// Robust losses: functions that reduce the weight of large residuals.
///
///     est.insertMeasurement(Observation(pose, landmark, z), slom::StandardDeviation(0.1), slom::Huber(1.345));
///
/// A measurement with whitened residual W r and s = |W r|^2 then adds rho(s) to the RSS instead of s.
///   scale c        in standard deviations (the length of W r), > 0; smaller residuals have nearly full weight
///   normalisation  rho(0) = 0, rho'(0) = 1, rho concave; the measurement's weight is rho'(s), 0 <= rho'(s) <= 1
/// With t = s / c^2:
///   Huber(c)             t <= 1: c^2 t, else c^2 (2 sqrt(t) - 1)       weight 1, 1 / sqrt(t)
///   PseudoHuber(c)       2 c^2 (sqrt(1 + t) - 1)                       weight 1 / sqrt(1 + t)
///   Cauchy(c)            c^2 log(1 + t)                                weight 1 / (1 + t)
///   GemanMcClure(c)      c^2 t / (1 + t)                               weight 1 / (1 + t)^2
///   Tukey(c)             t <= 1: c^2 (1 - (1 - t)^3) / 3, else c^2/3   weight (1 - t)^2, 0
///   Barron(alpha, c)     2 c^2 b/alpha ((1 + t/b)^(alpha/2) - 1)       weight (1 + t/b)^(-b/2),  b = 2 - alpha >= 0
/// Barron(alpha, c) is 2 c^2 rho(x, alpha, c) of the source. alpha = 2 is the square, 1 is PseudoHuber(c), 0 is
/// Cauchy(sqrt(2) c), -2 is GemanMcClure(2 c), and -infinity is Welsch's loss 2 c^2 (1 - exp(-t/2)).
///   sources  Huber, "Robust statistics", 1981; Holland and Welsch, "Robust regression using iteratively reweighted
///            least-squares", 1977 (for scalar residuals, 95 % efficiency on normal ones: Huber 1.345, Cauchy 2.385,
///            Tukey 4.685); Barron, "A general and adaptive robust loss function", CVPR 2019
#pragma once

#include <compare>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

#include "mtk/detail/cpp20.hpp"
#include "slom/model/loss_kinds.hpp"

namespace slom {

/// The table of losses: SCALED for losses with only a scale, SHAPED for losses with a shape before the scale. A new
/// loss is a line here, and a kind in loss_kinds.hpp. Everything else is made from this table: the class, losses(), and
/// the names in archives and in slom.
// clang-format off
#define SLOM_LOSSES(SCALED, SHAPED) \
  SCALED(Huber)                     \
  SCALED(PseudoHuber)               \
  SCALED(Cauchy)                    \
  SCALED(Tukey)                     \
  SCALED(GemanMcClure)              \
  SHAPED(Barron) /* Barron(alpha, c) with alpha <= 2; -infinity is allowed */
// clang-format on

/// Returns the losses of the library, in the order of the table.
std::span<const LossKind* const> losses();
/// Returns the library's loss of this stored name; null if there is none.
const LossKind* lossNamed(std::string_view stored_name);

/// A loss with its parameters. `Loss()` is no loss: rho(s) = s.
class Loss {
 public:
  /// Creates no loss: least squares.
  constexpr Loss() = default;
  /// Creates a loss of a kind with its scale c, in standard deviations of the whitened residual. Checked at insertion.
  constexpr Loss(const LossKind& kind, double scale, double shape = 0)
      : kind_(&kind), scale_(scale), shape_(shape) {}

  /// Returns the kind; null for no loss.
  const LossKind* kind() const { return kind_; }
  /// Returns c, in standard deviations of the whitened residual.
  double scale() const { return scale_; }
  /// Returns Barron's alpha; 0 for other losses.
  double shape() const { return shape_; }

  /// Returns rho and its derivatives at s >= 0, finite, with the scale c sqrt(graduation).
  LossValue evaluate(double s, double graduation = 1) const {
    if (kind_ == nullptr) return {s, 1, 0};
    const double c2 = scale_ * scale_ * graduation, t = s / c2, most = std::numeric_limits<double>::max();
    const LossValue unit = kind_->evaluate(t < most ? t : most, shape_);
    return {c2 * unit.rho, unit.first, unit.second / c2};
  }
  /// Returns text such as `Huber(1.345)`, `Barron(-2, 1.5)`, `none`.
  std::string text() const;
  /// Returns whether the scale is good and the shape is up to 2.
  constexpr bool hasGoodNumbers() const { return hasGoodScale() && shape_ <= 2; }
  /// Returns whether the scale is positive with a square in the range of double.
  constexpr bool hasGoodScale() const { return scale_ >= 1 / kMostScale && scale_ <= kMostScale; }
  /// Returns the fault of the loss's numbers, such as `has scale -1; pass ...`; empty if there is none.
  std::string fault() const;

  auto operator<=>(const Loss&) const = default;

 private:
  static constexpr double kMostScale = 1e150;  // squares are normal numbers

  const LossKind* kind_ = nullptr;
  double scale_ = 1;
  double shape_ = 0;
};

#define SLOM_SCALED_LOSS(Name)                                                   \
  struct Name : Loss {                                                           \
    explicit constexpr Name(double scale) : Loss(detail::losses::Name, scale) {} \
  };
#define SLOM_SHAPED_LOSS(Name)                                                               \
  struct Name : Loss {                                                                       \
    constexpr Name(double shape, double scale) : Loss(detail::losses::Name, scale, shape) {} \
  };
SLOM_LOSSES(SLOM_SCALED_LOSS, SLOM_SHAPED_LOSS)
#undef SLOM_SCALED_LOSS
#undef SLOM_SHAPED_LOSS

namespace detail {
/// Returns the kind of a loss that a program defines: one for each name and function. Copies the name.
const LossKind& ownKind(const char* name, LossValue (*evaluate)(double t, double shape));
[[noreturn]] void raiseLossError(const Loss& loss, const std::string& fault, const std::string& measurement);
}  // namespace detail

/// Returns a user-defined loss. f(t) must return phi(t), phi'(t) and phi''(t) for t = |W r|^2 / c^2 >= 0, with phi(0) =
/// 0, phi'(0) = 1 and 0 <= phi'(t) <= 1. Then rho(s) = c^2 phi(s / c^2). Insertion checks these conditions, and phi' by
/// differences. Such a loss cannot be saved to a file, so Archive refuses it.
///
///     slom::ownLoss("Welsch", 2.5, [](double t) { return slom::LossValue{1 - exp(-t), exp(-t), -exp(-t)}; })
template <class F>
Loss ownLoss(const char* name, double scale, F) {
  static_assert(std::is_empty_v<F> && std::is_default_constructible_v<F>,
                "slom: the function of a loss must not capture; write its numbers into the function");
  static_assert(std::is_same_v<decltype(F()(1.0)), LossValue>,
                "slom: the function of a loss must return a slom::LossValue: phi(t), phi'(t), phi''(t)");
  return Loss(detail::ownKind(name, [](double t, double) { return F()(t); }), scale);
}

/// A type that insertMeasurement accepts as a loss.
template <class T>
concept IsLoss = std::is_base_of_v<Loss, T>;

/// Throws [slom.bad-loss] with the name `subject()`, which is called only then.
template <class Subject>
void checkLoss(const Loss& loss, Subject&& subject) {
  if (const std::string fault = loss.fault(); !fault.empty()) detail::raiseLossError(loss, fault, subject());
}

}  // namespace slom
