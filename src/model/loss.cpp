#include "slom/model/loss.hpp"

#include <algorithm>
#include <cmath>
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

LossValue huber(double t) {
  if (t <= 1) return {t, 1, 0};
  const double root = std::sqrt(t);
  return {2 * root - 1, 1 / root, -0.5 / (t * root)};
}

LossValue pseudoHuber(double t) {
  const double root = std::sqrt(1 + t);
  return {2 * t / (root + 1), 1 / root, -0.5 / ((1 + t) * root)};
}

LossValue cauchy(double t) {
  const double weight = 1 / (1 + t);
  return {std::log1p(t), weight, -weight * weight};
}

LossValue tukey(double t) {
  if (t >= 1) return {1.0 / 3, 0, 0};
  return {t * (1 - t * (1 - t / 3)), (1 - t) * (1 - t), -2 * (1 - t)};
}

LossValue gemanMcClure(double t) {
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

}  // namespace

LossValue Loss::evaluate(double s, double graduation) const {
  if (kind_ == Kind::none) return {s, 1, 0};
  const double c2 = scale_ * scale_ * graduation;
  const double t = std::min(s / c2, std::numeric_limits<double>::max());
  const LossValue unit = [&]() -> LossValue {
    switch (kind_) {
      case Kind::none:
        break;
      case Kind::huber:
        return huber(t);
      case Kind::pseudo_huber:
        return pseudoHuber(t);
      case Kind::cauchy:
        return cauchy(t);
      case Kind::tukey:
        return tukey(t);
      case Kind::geman_mcclure:
        return gemanMcClure(t);
      case Kind::barron:
        return barron(t, shape_);
    }
    return {t, 1, 0};
  }();
  return {c2 * unit.rho, unit.first, unit.second / c2};
}

std::string Loss::text() const {
  const char* name = "none";
  switch (kind_) {
    case Kind::none:
      return name;
    case Kind::huber:
      name = "Huber";
      break;
    case Kind::pseudo_huber:
      name = "PseudoHuber";
      break;
    case Kind::cauchy:
      name = "Cauchy";
      break;
    case Kind::tukey:
      name = "Tukey";
      break;
    case Kind::geman_mcclure:
      name = "GemanMcClure";
      break;
    case Kind::barron:
      return "Barron(" + number(shape_, 6) + ", " + number(scale_, 6) + ")";
  }
  return std::string(name) + "(" + number(scale_, 6) + ")";
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
  return "";
}

void detail::raiseLossError(const Loss& loss, const std::string& fault, const std::string& subject) {
  throw mtk::Error("slom.bad-loss", "loss " + loss.text() + " of " + subject + " " + fault);
}

}  // namespace slom
