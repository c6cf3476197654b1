#include "slom/model/loss.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <string>
#include <utility>

#include "base/words.hpp"
#include "mtk/error.hpp"

namespace slom {

namespace {

/// Returns what is wrong with a user's function at scale 1; empty if nothing is.
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

std::span<const LossKind* const> losses() {
#define SLOM_LOSS_KIND(Name) &detail::losses::Name,
  static constexpr const LossKind* all[] = {SLOM_LOSSES(SLOM_LOSS_KIND, SLOM_LOSS_KIND)};
#undef SLOM_LOSS_KIND
  return all;
}

const LossKind* lossNamed(std::string_view stored_name) {
  const std::span<const LossKind* const> all = losses();
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const LossKind* kind) { return kind->stored_name == stored_name; });
  return found == all.end() ? nullptr : *found;
}

std::string Loss::text() const {
  if (kind_ == nullptr) return "none";
  return std::string(kind_->name) + "(" + (kind_->has_shape ? number(shape_, 6) + ", " : "") +
         number(scale_, 6) + ")";
}

const LossKind& detail::ownKind(const char* name, LossValue (*evaluate)(double t, double shape)) {
  static std::mutex mutex;
  static std::map<std::pair<std::string, LossValue (*)(double, double)>, LossKind> kinds;
  const std::lock_guard lock(mutex);
  const auto [it, is_new] = kinds.try_emplace({name == nullptr ? "" : name, evaluate});
  if (is_new) it->second = {it->first.first.c_str(), nullptr, false, evaluate};
  return it->second;
}

std::string Loss::fault() const {
  if (!hasGoodScale()) {
    return "has scale " + number(scale_, 6) +
           "; pass a positive finite number, in standard deviations of the residual";
  }
  if (!(shape_ <= 2)) {
    return "has shape " + number(shape_, 6) +
           "; pass a number up to 2: 2 is least squares, 1 PseudoHuber, 0 Cauchy, -2 GemanMcClure";
  }
  const bool is_own = kind_ != nullptr && kind_->stored_name == nullptr;
  return is_own ? faultOfFunction(*kind_) : "";
}

void detail::raiseLossError(const Loss& loss, const std::string& fault, const std::string& measurement) {
  throw mtk::Error("slom.bad-loss", "loss " + loss.text() + " of measurement " + measurement + " " + fault,
                   measurement);
}

}  // namespace slom
