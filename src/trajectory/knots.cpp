#include "slom/trajectory/knots.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mtk/error.hpp"

namespace slom::trajectory {

namespace {

std::string text(double x) { return mtk::detail::classicText("%.9g", x); }

}  // namespace

Knots::Knots(double start, double spacing) : start_(start), spacing_(spacing) {
  if (!std::isfinite(start)) {
    throw mtk::Error("slom.bad-knots", "the first knot is at " + text(start) + "; pass a finite time",
                     "start");
  }
  if (!(std::isfinite(spacing) && spacing > 0)) {
    throw mtk::Error("slom.bad-knots",
                     "the spacing of the knots is " + text(spacing) + "; pass a positive and finite number",
                     "spacing");
  }
}

Knots::Knots(std::vector<double> times) : times_(std::move(times)) {
  if (times_.size() < 2) {
    throw mtk::Error("slom.bad-knots",
                     "the number of knots is " + std::to_string(times_.size()) +
                         "; pass at least 2, or a start and a spacing",
                     "times");
  }
  for (std::size_t i = 0; i < times_.size(); ++i) {
    if (!std::isfinite(times_[i])) {
      throw mtk::Error("slom.bad-knots",
                       "knot " + std::to_string(i) + " is at " + text(times_[i]) + "; pass finite times",
                       "times");
    }
    if (i > 0 && !(times_[i - 1] < times_[i])) {
      throw mtk::Error("slom.bad-knots",
                       "knot " + std::to_string(i) + " is at " + text(times_[i]) + ", not after knot " +
                           std::to_string(i - 1) + " at " + text(times_[i - 1]) +
                           "; sort the knots and remove equal ones",
                       "times");
    }
  }
}

double Knots::operator[](std::int64_t i) const {
  if (times_.empty()) return start_ + static_cast<double>(i) * spacing_;
  const auto last = static_cast<std::int64_t>(times_.size()) - 1;
  if (i < 0) return times_.front() + static_cast<double>(i) * (times_[1] - times_[0]);
  if (i > last)
    return times_.back() + static_cast<double>(i - last) * (times_.back() - times_[times_.size() - 2]);
  return times_[static_cast<std::size_t>(i)];
}

std::int64_t Knots::uniformSegment(double t, double start, double spacing) const {
  constexpr double kMost = 0x1p52;
  const double index = std::floor((t - start) / spacing);
  if (!(std::abs(index) < kMost)) {
    throw mtk::Error("slom.bad-time",
                     "the time " + text(t) + " is more than 2^52 knots away from the knot at " + text(start) +
                         "; pass a time near the knots, in their unit",
                     "time");
  }
  return static_cast<std::int64_t>(index);
}

std::int64_t Knots::segmentAt(double t) const {
  if (!std::isfinite(t)) {
    throw mtk::Error("slom.bad-time", "the time on a spline is " + text(t) + "; pass a finite number",
                     "time");
  }
  std::int64_t i = 0;
  if (times_.empty()) {
    i = uniformSegment(t, start_, spacing_);
  } else if (t < times_.front()) {
    i = uniformSegment(t, times_.front(), times_[1] - times_[0]);
  } else if (t >= times_.back()) {
    i = uniformSegment(t, times_.back(), times_.back() - times_[times_.size() - 2]) +
        static_cast<std::int64_t>(times_.size()) - 1;
  } else {
    i = std::upper_bound(times_.begin(), times_.end(), t) - times_.begin() - 1;
  }
  // The quotient is rounded, the knots decide.
  if (t < (*this)[i]) --i;
  if (t >= (*this)[i + 1]) ++i;
  return i;
}

double Knots::timeOfControl(std::int64_t i, int order) const {
  double sum = 0;
  for (int k = 0; k + 1 < order; ++k) sum += (*this)[i - k] - (*this)[i];
  return (*this)[i] + sum / std::max(order - 1, 1);
}

}  // namespace slom::trajectory
