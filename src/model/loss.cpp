#include "slom/model/loss.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "base/words.hpp"
#include "mtk/error.hpp"

namespace slom {

namespace {

/// For b = 2 - alpha beyond this, Barron's loss is Welsch's to all digits.
constexpr double kWelsch = 1e100;
/// The squares of scales within [1 / kLargestScale, kLargestScale] are normal numbers.
constexpr double kLargestScale = 1e150;

// Each of these is for c = 1, where s = t: phi(t), phi'(t), phi''(t).

LossValue huber(double t, double) {
  if (t <= 1) return {t, 1, 0};
  const double root = std::sqrt(t);
  return {2 * root - 1, 1 / root, -0.5 / (t * root)};
}

LossValue pseudoHuber(double t, double) {
  const double root = std::sqrt(1 + t);
  return {2 * t / (root + 1), 1 / root, -0.5 / ((1 + t) * root)};
}

LossValue cauchy(double t, double) {
  const double weight = 1 / (1 + t);
  return {std::log1p(t), weight, -weight * weight};
}

LossValue tukey(double t, double) {
  if (t >= 1) return {1.0 / 3, 0, 0};
  return {t * (1 - t * (1 - t / 3)), (1 - t) * (1 - t), -2 * (1 - t)};
}

LossValue gemanMcClure(double t, double) {
  const double root = 1 / (1 + t);  // of the weight
  return {t * root, root * root, -2 * root * root * root};
}

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
  // phi = 2 b/alpha ((1 + t/b)^(alpha/2) - 1), in a form for each end: for small b the power is t/b times the weight,
  // for alpha around 0 the quotient tends to the logarithm.
  const double x = alpha / 2 * log;
  const double phi = alpha >= 1 ? 2 / alpha * (t * weight + b * std::expm1(-b / 2 * log))
                                : b * log * (x == 0 ? 1 : std::expm1(x) / x);
  return {phi, weight, -weight / 2 * (b / (b + t))};
}

/// What is wrong with a function that a user wrote, at scale 1; empty when nothing is.
std::string faultOfFunction(const LossKind& kind) {
  constexpr double same = 1e-9, h = 1e-5, close = 1e-4;
  const auto at = [&](double t) { return kind.evaluate(t, 0); };
  const LossValue zero = at(0);
  if (!(std::abs(zero.rho) <= same && std::abs(zero.first - 1) <= same)) {
    return "has phi(0) = " + number(zero.rho) + " and phi'(0) = " + number(zero.first) +
           "; let phi begin at 0 with slope 1, as least squares do";
  }
  for (const double t : {0.01, 0.3, 0.9, 2.0, 10.0, 1e4}) {
    const LossValue value = at(t);
    if (!(value.first >= 0 && value.first <= 1 + same) || !std::isfinite(value.rho) ||
        !std::isfinite(value.second)) {
      return "has phi(" + number(t) + ") = " + number(value.rho) + ", phi' = " + number(value.first) +
             ", phi'' = " + number(value.second) + "; let all be finite, and phi' between 0 and 1";
    }
    const double slope = (at(t * (1 + h)).rho - at(t * (1 - h)).rho) / (2 * h * t);
    if (!(std::abs(slope - value.first) <= close * std::max(slope, value.rho / t))) {
      return "has phi'(" + number(t) + ") = " + number(value.first) + " where differences of phi give " +
             number(slope) + "; let phi' be the derivative of phi";
    }
  }
  return "";
}

}  // namespace

const LossKind detail::kLossKinds[6] = {{"Huber", "huber", false, &huber},
                                        {"PseudoHuber", "pseudo-huber", false, &pseudoHuber},
                                        {"Cauchy", "cauchy", false, &cauchy},
                                        {"Tukey", "tukey", false, &tukey},
                                        {"GemanMcClure", "geman-mcclure", false, &gemanMcClure},
                                        {"Barron", "barron", true, &barron}};

const LossKind* lossNamed(std::string_view stored_name) {
  const auto* const found =
      std::find_if(std::begin(detail::kLossKinds), std::end(detail::kLossKinds),
                   [&](const LossKind& kind) { return kind.stored_name == stored_name; });
  return found == std::end(detail::kLossKinds) ? nullptr : found;
}

LossValue Loss::evaluate(double s, double graduation) const {
  if (kind_ == nullptr) return {s, 1, 0};
  const double c2 = scale_ * scale_ * graduation;
  const double t = std::min(s / c2, std::numeric_limits<double>::max());
  const LossValue unit = kind_->evaluate(t, shape_);
  return {c2 * unit.rho, unit.first, unit.second / c2};
}

std::string Loss::text() const {
  if (kind_ == nullptr) return "none";
  return std::string(kind_->name) + "(" + (kind_->has_shape ? number(shape_, 6) + ", " : "") +
         number(scale_, 6) + ")";
}

std::string detail::faultOf(const Loss& loss) {
  if (!(loss.scale() >= 1 / kLargestScale && loss.scale() <= kLargestScale)) {
    return "has scale " + number(loss.scale(), 6) +
           "; pass a positive finite number, in standard deviations of the residual";
  }
  if (!(loss.shape() <= 2)) {
    return "has shape " + number(loss.shape(), 6) +
           "; pass a number up to 2: 2 is least squares, 1 PseudoHuber, 0 Cauchy, -2 GemanMcClure";
  }
  const bool is_own = loss.kind() != nullptr && loss.kind()->stored_name == nullptr;
  return is_own ? faultOfFunction(*loss.kind()) : "";
}

void detail::raiseLossError(const Loss& loss, const std::string& fault, const std::string& subject) {
  throw mtk::Error("slom.bad-loss", "loss " + loss.text() + " of " + subject + " " + fault);
}

}  // namespace slom
