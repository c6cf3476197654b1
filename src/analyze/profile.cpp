#include "analyze/profile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "base/index.hpp"
#include "base/words.hpp"
#include "problem/value_snapshot.hpp"

namespace slom {

namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();

std::vector<double> coordinatesOf(const Problem& problem, int variable) {
  const VariableRecord& record = problem.variables()[at(variable)];
  std::vector<double> x(at(record.dof));
  record.store->coordinates(record.store->valueAt(record.slot), x.data());
  return x;
}

/// One coordinate of a variable, which is moved while everything else is fitted again.
class Profile {
 public:
  Profile(Problem& problem, const ProfiledFit& fit, int variable, int component)
      : problem_(problem),
        fit_(fit),
        variable_(variable),
        components_{component},
        record_(problem.variables()[at(variable)]),
        component_(component),
        x_(coordinatesOf(problem, variable)) {}

  ProfileInterval interval() {
    factor_ = fit_.variance_factor();
    if (!fit_.is_at_minimum(factor_)) {
      throw Error("slom.not-a-minimum",
                  "the profile of " + problem_.componentNames(variable_)[at(component_)] +
                      " needs the values of a converged fit; call optimize() first",
                  problem_.componentNames(variable_)[at(component_)]);
    }
    const ActiveSet& active = problem_.activeSet();
    if (!active.isOptimized(variable_) || active.isFixed(variable_, component_))
      return {value(), value(), value()};
    const ComponentBound* const found = active.boundOf(variable_, component_);
    const ComponentBound bound =
        found == nullptr ? ComponentBound{component_, -kUnlimited, kUnlimited} : *found;
    best_ = fit_.rss();
    const double half_width = fit_.half_width(component_);
    rise_ = factor_ * half_width * half_width;
    ValueSnapshot start(problem_);
    const auto restore = [&] {
      problem_.setFixed(variable_, components_, false);
      start.restore();
      problem_.setBound(variable_, components_, bound.lower, bound.upper);
    };
    try {
      const ProfileInterval result = search(bound, found != nullptr, start);
      restore();
      return result;
    } catch (...) {
      restore();
      throw;
    }
  }

 private:
  double value() const { return x_[at(component_)]; }

  ProfileInterval search(const ComponentBound& bound, bool is_bounded, ValueSnapshot& start) {
    // Without the bound, the coordinate has a covariance even if it is at the bound.
    if (is_bounded) problem_.setBound(variable_, components_, -kUnlimited, kUnlimited);
    std::vector<double> C(at(record_.dof * record_.dof));
    fit_.covariance(C.data());
    guess_ = std::sqrt(rise_ / factor_ * C[at(component_ * (record_.dof + 1))]);
    problem_.setFixed(variable_, components_, true);
    const double to_upper = bound.upper - value(), to_lower = value() - bound.lower;
    const double above = ascend(1, to_upper, start), below = ascend(-1, to_lower, start);
    return {value(), below < to_lower ? value() - below : std::min(bound.lower, value()),
            above < to_upper ? value() + above : std::max(bound.upper, value())};
  }

  /// Returns the distance at which the RSS has risen by rise_; at most `most`.
  double ascend(double sign, double most, ValueSnapshot& start) {
    constexpr int small_steps = 8;
    if (!(most > 0)) return 0;
    start.restore();
    // Each refit starts from the farthest values inside the interval.
    auto inside = std::make_unique<ValueSnapshot>(problem_);
    double inside_at = 0;
    bool has_crossed = false;
    const auto excessAfter = [&](double from, double to) {
      shift(sign * (to - from));
      const double excess = (fit_.refit() - best_) / rise_ - 1;
      if (!(excess > 0)) {
        inside = std::make_unique<ValueSnapshot>(problem_);
        inside_at = to;
      }
      return excess;
    };
    return profileRoot(
        [&](double t) {
          inside->restore();
          double excess = excessAfter(inside_at, t);
          // A long step may lead to another minimum of the rest. Small steps follow the minimum of the fit.
          for (int k = 1; k <= small_steps && excess > 0 && !has_crossed; ++k) {
            const double from = inside_at, to = from + (t - from) / (small_steps + 1 - k);
            inside->restore();
            const double after = excessAfter(from, to);
            has_crossed = after > 0;
            if (k == small_steps) excess = after;
          }
          return excess;
        },
        guess_, most);
  }
  void shift(double step) {
    std::vector<double> d(at(record_.dof), 0.0);
    d[at(component_)] = step;
    record_.store->boxplus(record_.store->valueAt(record_.slot), d.data());
    problem_.overwrite(variable_, record_.store->valueAt(record_.slot));
  }

  Problem& problem_;
  const ProfiledFit& fit_;
  int variable_;
  std::vector<int> components_;
  const VariableRecord& record_;
  int component_;
  std::vector<double> x_;  // at the fit
  double factor_ = 1, best_ = 0, rise_ = 0, guess_ = 0;
};

}  // namespace

ProfileInterval profileLikelihood(Problem& problem, const ProfiledFit& fit, int variable, int component) {
  return Profile(problem, fit, variable, component).interval();
}

int profiledComponent(const Problem& problem, int variable, const std::string& path) {
  const std::vector<int> components = problem.componentsAt(variable, path);
  if (components.size() == 1 && isCoordinate(problem, variable, components.front()))
    return components.front();
  throw Error("slom.no-component",
              path + " of variable " + problem.variableName(variable) +
                  " is not one coordinate; profile takes one component of a vector at a time",
              problem.variableName(variable));
}

bool isCoordinate(const Problem& problem, int variable, int component) {
  return !std::isnan(coordinatesOf(problem, variable)[at(component)]);
}

void requireProbabilityOfProfile(double probability) {
  if (probability > 0 && probability < 1) return;
  throw Error("slom.bad-option",
              "the probability of a profile interval is " + number(probability, 6) +
                  "; pass one between 0 and 1, such as 0.95",
              "probability");
}

double profileRoot(const std::function<double(double)>& f, double guess, double most) {
  // The unknown s = sqrt(f + 1) is nearly proportional to t. The Illinois variant of the false position finds its root.
  const auto excess = [&](double t) { return std::sqrt(std::max(0.0, f(t) + 1)) - 1; };
  double low = 0, at_low = -1, high = std::min(guess, most), at_high = excess(high);
  while (!(at_high > 0)) {
    if (high >= most) return most;
    if (high > 500 * guess) return std::numeric_limits<double>::infinity();
    low = high;
    at_low = at_high;
    high = std::min(2 * high, most);
    at_high = excess(high);
  }
  int side = 0;
  for (int i = 0; i < 60 && high - low > 1e-7 * high; ++i) {
    const double t =
        std::isfinite(at_high) ? (low * at_high - high * at_low) / (at_high - at_low) : (low + high) / 2;
    const double at_t = excess(t);
    if (std::abs(at_t) < 1e-8) return t;
    if (at_t > 0) {
      high = t;
      at_high = at_t;
      if (side == 1) at_low /= 2;
      side = 1;
    } else {
      low = t;
      at_low = at_t;
      if (side == -1) at_high /= 2;
      side = -1;
    }
  }
  return (low + high) / 2;
}

}  // namespace slom
