#include "slom/trajectory/spline_state.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mtk/error.hpp"

namespace slom::trajectory::detail {

namespace {

std::string text(double x) { return mtk::detail::classicText("%.9g", x); }

/// Returns how far from a knot times may be, in spacings, and do not move to the next segment. Polynomials of two segments
/// agree at their knot to order - 2 derivatives, so second derivatives that near to it agree to 1e-6 of the change over a
/// spacing.
double nearness(int order) {
  constexpr double kLeast = 1e-6;
  return order == 6 ? std::cbrt(6 * kLeast) : order == 5 ? std::sqrt(2 * kLeast) : kLeast;
}

int countUses(const Estimator& est, const AnyVarID& id) {
  int count = 0;
  est.table().forEachUse(est.table().indexOf(id), [&](const auto&, int) { ++count; });
  return count;
}

}  // namespace

MovingMeasurement::~MovingMeasurement() = default;

SplineState::SplineState(Knots all_knots, std::string its_name, int its_order, Ties its_ties)
    : knots(std::move(all_knots)), name(std::move(its_name)), order(its_order), kind_(its_ties) {}
SplineState::~SplineState() = default;

std::int64_t SplineState::coveredSegment(double t) const {
  const std::int64_t segment = knots.segmentAt(t), first = firstSegment(), last = lastSegment();
  if (segment >= first && segment <= last) return segment;
  if (last >= first && segment == last + 1 && t == knots[segment]) return last;
  const std::string range =
      last < first ? "has no control points yet"
                   : "covers the times from " + text(knots[first]) + " to " + text(knots[last + 1]);
  throw mtk::Error(
      "slom.uncovered-time",
      "spline " + name + " " + range + ", and the time is " + text(t) + "; call extend(est, from, to) first",
      name);
}

std::int64_t SplineState::nextSegment(double t, std::int64_t present) const {
  return std::clamp(knots.segmentAt(t), present - kMostAtOnce, present + kMostAtOnce);
}

bool SplineState::isOutside(double t, std::int64_t segment, int returns) const {
  // A residual may have a kink at a knot: on a spline of order 4, the acceleration has one.
  constexpr double kMost = 0.25;
  const double begin = knots[segment], end = knots[segment + 1],
               margin = std::min(nearness(order) * std::pow(4.0, returns), kMost) * (end - begin);
  return !(t >= begin - margin && t <= end + margin);
}

void SplineState::grow(Estimator& est, bool at_front, bool tied) {
  const std::int64_t i = at_front ? first_ - 1 : first_ + count();
  add(est, i, at_front);
  if (at_front) first_ = i;
  if (tied || kind_ == Ties::all) tieTo(est, i, at_front ? 1 : -1);
}

void SplineState::tieTo(Estimator& est, std::int64_t i, std::int64_t step) {
  const auto found = ties_.find(i);
  const bool is_process = kind_ == Ties::all;
  if (count() < (is_process ? 2 : 4) || (found != ties_.end() && found->second.id.isValid())) return;
  ties_[i] = {tie(est, i, step), i + (is_process ? 1 : 2) * step};
}

void SplineState::tieEnds(Estimator& est, bool renew) {
  if (kind_ == Ties::all) return;
  const std::int64_t last = first_ + count() - 1;
  for (std::int64_t k = 0; renew && k + 1 < order; ++k) {
    for (const std::int64_t i : {first_ + k, last - k}) {
      const auto found = ties_.find(i);
      if (found == ties_.end()) continue;
      if (found->second.id.isValid()) est.removeMeasurement(found->second.id);
      ties_.erase(found);
    }
  }
  for (std::int64_t k = 0; k + 1 < order; ++k) {
    tieTo(est, first_ + k, 1);
    tieTo(est, last - k, -1);
  }
}

void SplineState::cover(Estimator& est, std::int64_t first_segment, std::int64_t last_segment, bool tied) {
  if (count() == 0) first_ = first_segment;
  while (lastSegment() < last_segment) grow(est, false, tied);
  while (first_ > first_segment) grow(est, true, tied);
}

void SplineState::cover(Estimator& est, double from, double to) {
  const std::int64_t first_segment = knots.segmentAt(from);
  std::int64_t last_segment = knots.segmentAt(to);
  if (to < from) {
    throw mtk::Error("slom.bad-time",
                     "spline " + name + " is to cover the times from " + text(from) + " to " + text(to) +
                         ", which is earlier; exchange them",
                     name);
  }
  if (to == knots[last_segment] && last_segment > first_segment) --last_segment;  // the end of a segment
  cover(est, first_segment, last_segment, false);
}

std::vector<std::int64_t> SplineState::tiesOf(std::int64_t i) const {
  std::vector<std::int64_t> result;
  for (std::int64_t k = i - 2; k <= i + 2; ++k) {
    const auto found = ties_.find(k);
    if (found == ties_.end() || !found->second.id.isValid()) continue;
    if (std::min(k, found->second.other_end) <= i && i <= std::max(k, found->second.other_end))
      result.push_back(k);
  }
  return result;
}

void SplineState::trim(Estimator& est) {
  for (const bool at_front : {true, false}) {
    while (count() > order) {
      const std::int64_t i = at_front ? first_ : first_ + count() - 1;
      const std::vector<std::int64_t> ties = tiesOf(i);
      if (countUses(est, end(at_front)) > static_cast<int>(ties.size())) break;
      for (const std::int64_t k : ties) {
        est.removeMeasurement(ties_[k].id);
        ties_.erase(k);
      }
      remove(est, at_front);
      if (at_front) ++first_;
    }
  }
}

}  // namespace slom::trajectory::detail
